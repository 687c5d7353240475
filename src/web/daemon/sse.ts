// Server-sent events from a text stream. EventSource cannot send a key, so the page reads them itself.

// Takes text as it arrives and returns the data of every event that is complete.
export class EventReader {
  private rest = '';

  take(text: string): string[] {
    this.rest += text;
    const blocks = this.rest.split('\n\n');
    this.rest = blocks.pop() ?? '';
    return blocks.map(dataOf).filter((data) => data !== '');
  }
}

function dataOf(block: string): string {
  return block.split('\n').filter((line) => line.startsWith('data:'))
    .map((line) => line.slice(5).trimStart()).join('\n');
}
