// Server-sent events from a text stream. EventSource cannot send a key, so the page reads them itself.

export interface ServerEvent {
  name: string;
  id: string;  // '' where it has none
  data: string;
}

// Takes text as it arrives and returns every event that is complete.
export class EventReader {
  private rest = '';

  take(text: string): ServerEvent[] {
    this.rest += text;
    const blocks = this.rest.split('\n\n');
    this.rest = blocks.pop() ?? '';
    return blocks.map(eventOf).filter(({ data }) => data !== '');
  }
}

function eventOf(block: string): ServerEvent {
  const values = (field: string): string[] => block.split('\n').filter((line) => line.startsWith(`${field}:`))
    .map((line) => line.slice(field.length + 1).trimStart());
  return { name: values('event').pop() ?? 'message', id: values('id').pop() ?? '', data: values('data').join('\n') };
}
