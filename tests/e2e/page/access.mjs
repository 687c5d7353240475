// Keys, refusals, hostile names, empty states and the keyboard: what a page does when things are not smooth.
import assert from 'node:assert/strict';
import { after, afterEach, before, describe, test } from 'node:test';
import { assertAccessible, assertNoSideways, Browser, drop, missing, screenshot } from './browser.mjs';
import { until, Workshop } from './workshop.mjs';

const WAIT = { 'wait.sh': '#!/bin/sh\nexec sleep 1000\n' };
const OBJET = () => '[printer.objet]\nprofile = "objet30"\nhandoff_folder = "out"\n';
const STL = 'solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 9 0\nendloop\nendfacet\nendsolid a\n';
const HOSTILE = ['<img src=x onerror=window.hit=1>.stl', '"><svg onload=window.hit=1>.stl', "'-window.hit=1-'.stl",
                 '{{constructor.constructor(window.hit=1)()}}.stl', '‮lts.exe.stl'];

describe('the page', { skip: missing }, () => {
  let shop;
  let browser;
  before(async () => {
    browser = await Browser.open();
    shop = await Workshop.open({ printers: OBJET, files: WAIT, settings: '[prepare]\nprogram = "wait.sh"', web: 'most_upload_bytes = 1048576' });
  });
  after(async () => {
    await browser?.close();
    await shop?.close();
  });
  afterEach(() => browser.assertClean());
  const note = (page, text) => page.locator('.note', { hasText: text }).waitFor();

  test('what is empty says what to do next', async () => {
    const page = await browser.visit(shop.base);
    await page.getByText('Drop a model on this page').waitFor();
    assert.match(await page.locator('.queue, .empty').first().innerText(), /folders\/objet/);
    await page.getByRole('link', { name: 'History' }).click();
    await page.getByText('Nothing has ended yet').waitFor();
    await page.goto(`${shop.base}/#/jobs/4711`);
    await page.getByText('There is no job 4711').waitFor();
  });

  test('nothing is changed without a key, and a wrong one is told', async () => {
    const page = await browser.visit(shop.base);
    await page.getByRole('button', { name: 'Pause objet' }).click();
    const dialog = page.getByRole('dialog', { name: 'Your key' });
    await dialog.getByText('packmerger keys add').waitFor();
    await assertAccessible(page, 'the key dialogue');
    await dialog.getByLabel('Key').fill('pm_wrong');
    await dialog.getByRole('button', { name: 'Use this key' }).click();
    await dialog.getByText('The key is wrong or was revoked').waitFor();
    assert.equal((await shop.ask('printers'))[0].paused, false);
    assert.equal(await page.evaluate(() => sessionStorage.length + localStorage.length), 0, 'a wrong key is not kept');
    await dialog.getByLabel('Key').fill(shop.key);
    await dialog.getByRole('button', { name: 'Use this key' }).click();
    await page.getByRole('button', { name: 'Resume objet' }).waitFor();
    assert.equal((await shop.ask('printers'))[0].paused, true, 'what was asked for is done once there is a key');
    assert.equal(await page.evaluate(() => localStorage.length), 0, 'kept for this tab alone');
    await page.getByRole('button', { name: 'Resume objet' }).click();
    await page.getByRole('button', { name: 'Pause objet' }).waitFor();
  });

  test('a key can be remembered and forgotten', async () => {
    const page = await browser.visit(shop.base);
    await page.getByRole('button', { name: 'Your key' }).click();
    await page.getByLabel('Key', { exact: true }).fill(shop.key);
    await page.getByLabel('Remember it on this device').check();
    await page.getByRole('button', { name: 'Use this key' }).click();
    await page.getByRole('dialog').waitFor({ state: 'detached' });
    assert.equal(await page.evaluate(() => localStorage.getItem('packmerger-key')), shop.key);
    await page.getByRole('button', { name: 'Your key' }).click();
    await page.getByRole('button', { name: 'Forget the key' }).click();
    await note(page, 'forgotten');
    assert.equal(await page.evaluate(() => localStorage.length), 0);
  });

  test('from elsewhere the page asks for a key before it shows anything', async () => {
    const page = await browser.visit(shop.base);
    await page.setExtraHTTPHeaders({ 'X-Forwarded-For': '10.0.0.9' });
    await page.reload();
    await page.getByRole('heading', { name: 'This needs a key' }).waitFor();
    await page.getByText('Key needed').waitFor();
    assert.match(await page.locator('.key-page').innerText(), /a link is enough: packmerger keys link prints one/);
    assert.equal(await page.locator('.printer').count(), 0);
    await assertAccessible(page, 'the key page');
    await page.getByLabel('Key', { exact: true }).fill(shop.key);
    await page.keyboard.press('Enter');
    await page.locator('.printer').waitFor();
    await page.getByText('Live').waitFor();
  });

  test('a link from the daemon lets a browser look, and a key is asked for to change something', async () => {
    const page = await browser.visit(shop.base);
    await page.setExtraHTTPHeaders({ 'X-Forwarded-For': '10.0.0.9' });
    await page.reload();
    await page.getByRole('heading', { name: 'This needs a key' }).waitFor();
    const link = shop.shell('keys', 'link').trim().replace('localhost', '127.0.0.1');
    await page.goto(link);
    await page.locator('.printer').waitFor();
    assert.equal(new URL(page.url()).hash, '#/', 'the code stands in no bookmark');
    await page.reload();
    await page.locator('.printer').waitFor();
    await page.getByRole('button', { name: 'Pause objet' }).click();
    await page.getByRole('dialog', { name: 'Your key' }).waitFor();
    assert.equal((await shop.ask('printers'))[0].paused, false);
    const other = await browser.visit(shop.base);
    await other.goto(link);
    await other.locator('.note', { hasText: 'used already' }).waitFor();
  });

  test('files that cannot be taken are told, each with what to do', async () => {
    const page = await browser.visit(shop.base, { key: shop.key });
    await page.getByText('1 MiB each at most').waitFor();
    await drop(page, [{ name: 'virus.exe', text: 'x' }, { name: 'big.stl', text: 'x'.repeat(2 << 20) }, { name: 'empty.stl', text: '' }],
               '[data-printer=objet].drop-target');
    for (const text of ['It takes STL', 'Raise web.most_upload_bytes', 'Export it anew']) await page.getByText(text).waitFor();
    assert.equal((await shop.ask('jobs')).length, 0);
    await screenshot(page, 'refused-uploads');
    await page.getByRole('button', { name: 'virus.exe' }).click();
    await page.getByText('It takes STL').waitFor({ state: 'detached' });
  });

  test('what only the daemon can know is told in its words', async () => {
    const page = await browser.visit(shop.base);
    await page.route('**/api/v1/uploads', (route) => route.abort());
    await page.evaluate((key) => sessionStorage.setItem('packmerger-key', key), shop.key);
    await page.reload();
    await page.locator('input[type=file]').setInputFiles({ name: 'a.exe', mimeType: 'application/octet-stream', buffer: Buffer.from('x') });
    await page.locator('.refused', { hasText: 'Send' }).waitFor();
    await page.route('**/api/v1/jobs', (route) => route.fulfill({
      status: 507, contentType: 'application/json', body: '{"error": {"fault": 74, "what": "The disk is full", "hint": "Make room."}}' }));
    await page.locator('input[type=file]').setInputFiles({ name: 'b.stl', mimeType: 'model/stl', buffer: Buffer.from(STL) });
    await page.locator('.refused', { hasText: 'The disk is full. Make room.' }).waitFor();
    await page.unroute('**/api/v1/jobs');
  });

  test('names never become anything but text', async () => {
    const page = await browser.visit(shop.base, { key: shop.key });
    await page.locator('.chooser').waitFor();
    for (const name of HOSTILE) await shop.upload('objet', name, STL);
    for (const job of await shop.ask('jobs')) await page.locator(`[data-job="${job.id}"] h3`, { hasText: job.name }).waitFor();
    assert.equal((await shop.ask('jobs')).length, HOSTILE.length);
    await page.goto(`${shop.base}/#/jobs/1`);
    await page.getByRole('heading', { name: HOSTILE[0] }).waitFor();
    await page.getByRole('button', { name: 'Cancel job 1' }).click();
    await page.getByRole('dialog').getByRole('button', { name: 'Keep it' }).click();
    assert.equal(await page.locator('img, svg[onload], script:not([src])').count(), 0);
    assert.equal(await page.evaluate(() => window.hit), undefined);
    await assertNoSideways(page, 'hostile names');
    for (const job of await shop.ask('jobs')) await shop.ask(`jobs/${job.id}/cancel`, 'POST');
    await page.goto(`${shop.base}/#/history`);
    await page.getByRole('link', { name: '><svg onload=window.hit=1>.stl' }).waitFor();
    await page.getByLabel('Find').fill('constructor');
    await until('one is found', async () => (await page.locator('.history > li').count()) === 1);
    assert.equal(await page.evaluate(() => window.hit), undefined);
  });

  test('the history goes back to the first job', async () => {
    const count = 110;
    for (let i = 0; i < count; i += 1) {
      const job = await shop.upload('objet', `old-${i}.stl`, STL);
      await shop.ask(`jobs/${job.id}/cancel`, 'POST');
    }
    const page = await browser.visit(shop.base, { view: '#/history', key: shop.key });
    await until('what the stream tells', async () => (await page.locator('.history > li').count()) === 100);
    const known = (await shop.ask('jobs?limit=1000')).filter((job) => job.ended_s !== null).map((job) => job.id);
    const more = page.getByRole('button', { name: 'Show older jobs' });
    await more.focus();
    await page.keyboard.press('Enter');
    await until('all of them', async () => (await page.locator('.history > li').count()) === known.length);
    assert.deepEqual(await page.locator('.history > li').evaluateAll((rows) => rows.map((row) => Number(row.dataset.job))), known);
    assert.equal(await more.count(), 0, 'there is nothing older');
    const late = await shop.upload('objet', 'late.stl', STL);
    await shop.ask(`jobs/${late.id}/cancel`, 'POST');
    await until('the new one too, and none is pushed out', async () => (await page.locator('.history > li').count()) === known.length + 1);
    await assertAccessible(page, 'a long history');
  });

  test('everything is reached by the keyboard alone', async () => {
    const page = await browser.visit(shop.base, { key: shop.key });
    const job = await shop.upload('objet', 'keys.stl', STL);
    await page.locator(`[data-job="${job.id}"]`).waitFor();
    const visited = [];
    for (let presses = 0; presses < 25; presses += 1) {
      await page.keyboard.press('Tab');
      visited.push(await page.evaluate(() => {
        const at = document.activeElement;
        const outline = getComputedStyle(at);
        return { name: at.getAttribute('aria-label') ?? at.textContent, seen: outline.outlineStyle !== 'none' && parseFloat(outline.outlineWidth) >= 2 };
      }));
      if (visited.at(-1).name.startsWith('Cancel job')) break;
    }
    const names = visited.map((one) => one.name);
    const order = ['To the content', 'PackMerger', 'Now', 'History', 'Your key', 'Switch to dark', '', 'Choose files', 'Pause objet', 'keys.stl', 'Hold job', 'Cancel job'];
    let from = -1;
    for (const wanted of order) {
      const found = names.findIndex((name, index) => index > from && name.includes(wanted));
      assert.ok(found > from, `${wanted} comes in its turn: ${names.join(' | ')}`);
      from = found;
    }
    assert.deepEqual(visited.filter((one) => !one.seen), [], 'the focus is seen everywhere');
    await page.keyboard.press('Enter');
    await page.getByRole('dialog').waitFor();
    await page.keyboard.press('Escape');
    await page.locator('dialog').waitFor({ state: 'detached' });
    assert.match(await page.evaluate(() => document.activeElement.getAttribute('aria-label')), /^Cancel job/, 'the focus returns');
    assert.equal((await shop.job(job.id)).state, 'preparing', 'Escape cancels nothing');
    await page.keyboard.press('Enter');
    await page.getByRole('dialog').waitFor();
    await page.keyboard.press('Tab');
    await page.keyboard.press('Enter');
    await until('it is cancelled', async () => (await shop.job(job.id)).state === 'cancelled');
  });

  test('colours are switched and stay switched', async () => {
    const page = await browser.visit(shop.base);
    const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    await page.locator('.printer').waitFor();
    const light = await ground();
    await page.getByRole('button', { name: 'Switch to dark colours' }).click();
    const dark = await ground();
    assert.notEqual(dark, light);
    await page.reload();
    await page.getByRole('button', { name: 'Switch to light colours' }).waitFor();
    assert.equal(await ground(), dark);
    assert.equal(await (await browser.visit(shop.base, { theme: 'dark' })).evaluate(() => getComputedStyle(document.body).backgroundColor), dark);
  });

  test('a daemon that goes and comes is told, and nothing is lost', async () => {
    const page = await browser.visit(shop.base);
    await page.getByText('Live').waitFor();
    await shop.stopDaemon();
    await page.getByText('The daemon does not answer').waitFor();
    await page.getByText('No connection').waitFor();
    assert.equal(await page.locator('.printer').count(), 1, 'what was known is still shown');
    await assertAccessible(page, 'without the daemon');
    await shop.startDaemon();
    await page.getByText('Live').waitFor({ timeout: 20_000 });
    assert.equal(await page.getByText('The daemon does not answer').count(), 0);
  });

  test('the daemon without printers says how to name one', async () => {
    const bare = await Workshop.open({ printers: () => '' });
    try {
      const page = await browser.visit(bare.base);
      await page.getByText('No printer yet').waitFor();
      await page.getByText('systemctl reload packmergerd').waitFor();
      await assertAccessible(page, 'no printers');
      await screenshot(page, 'no-printers');
      for (let wrong = 0; wrong < 12; wrong += 1)
        await fetch(`${bare.base}/api/v1/printers`, { headers: { 'X-Api-Key': `pm_${wrong}` } });
      await page.reload();
      await page.getByText('No printer yet').waitFor();  // whoever guesses keys shuts nobody out
    } finally {
      await bare.close();
    }
  });
});
