// A model dropped for any of the printers: how they were compared, and the proposal accepted by the keyboard alone.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { assertAccessible, assertNoSideways, Browser, drop, missing, screenshot } from './browser.mjs';
import { until, Workshop } from './workshop.mjs';

// Alike, but that an hour of the one costs more; nothing large fits the third.
const machine = (name, more) => `base = "marlin"\nname = "${name}"\n${more}`;
const FILES = {
  'dear.toml': machine('A dear machine', '[cost]\nmachine_price_per_h = 50\n'),
  'fair.toml': machine('A fair machine', '[cost]\nmachine_price_per_h = 1\n'),
  'tiny.toml': machine('A tiny machine', 'build_mm = [12, 12, 12]\n'),
};
// A pyramid: the comparison of every printer has little to do.
const PYRAMID = 'v 0 0 0\nv 40 0 0\nv 40 40 0\nv 0 40 0\nv 20 20 30\nf 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n';
const NAMES = ['dear', 'fair', 'tiny'];
const PRINTERS = (ports) => NAMES.map((name) => `[printer.${name}]
profile = "${name}.toml"
port = "${ports[name]}"
simulated = true
variant = "solid"
split = false
`).join('') + '[printer.any]\nprofile = "auto"\nsize_mm = 22\n';

describe('a proposal', { skip: missing }, () => {
  let shop;
  let browser;
  before(async () => {
    shop = await Workshop.open({
      printers: PRINTERS, files: FILES, settings: '[prepare]\nbudget_s = 1',
      machines: Object.fromEntries(NAMES.map((name) => [name, [`${name}.toml`, '--speed', 'inf']])) });
    browser = await Browser.open();
  });
  after(async () => {
    await browser?.close();
    await shop?.close();
  });

  test('shows what each printer would take, and is accepted by keyboard', async () => {
    const page = await browser.visit(shop.base, { key: shop.key });
    await page.locator('.printer').first().waitFor();
    await drop(page, [{ name: 'anywhere.obj', text: PYRAMID }], '[data-printer=any].drop-target');
    await page.locator('[data-job="1"]').waitFor();
    const job = await until('the job is ready', async () => {
      const now = await shop.job(1);
      assert.notEqual(now.state, 'failed', `${now.reason} ${now.hint}`);
      return now.state === 'ready' ? now : null;
    }, 400);
    assert.equal(job.printer, 'fair');
    assert.equal(job.waits_for, 'approval', 'nobody named that printer');
    const { solid } = job.estimates;
    const cheaper = Object.values(job.estimates).some((one) => one.fits && one.cost < solid.cost);
    assert.match(job.reason, cheaper ? /^prepared solid: printed [a-z ]+ it costs less$/ : /^$/);
    const queue = page.locator('[data-job="1"]');
    await queue.getByText('Ready to approve').waitFor();
    const queued = await queue.innerText();
    assert.ok(queued.includes(solid.cost.toFixed(2)), `${queued} tells what was prepared, which costs ${solid.cost}`);
    assert.ok(queued.includes(job.reason.replace('prepared', 'Prepared')), queued);

    await page.goto(`${shop.base}/#/jobs/1`);
    const table = page.getByRole('region', { name: 'Why this printer' });
    await table.getByText('The cheapest is proposed').waitFor();
    const row = (name) => table.getByRole('row').filter({ has: page.getByRole('rowheader', { name, exact: false }) });
    const told = Object.fromEntries(job.choice.printers.map((one) => [one.printer, one]));
    assert.ok(told.dear.cost > told.fair.cost && !told.tiny.fits, JSON.stringify(told));
    for (const name of ['dear', 'fair']) {
      const cells = (await row(name).getByRole('cell').allInnerTexts()).map((text) => text.replace(/[^0-9.]/g, ''));
      assert.equal(cells.length, 3);
      assert.ok(cells[0] !== '' && cells[2] !== '', `${name} has its times`);
      assert.ok(Math.abs(Number(cells[1]) - told[name].cost) < 0.011, `${name}: ${cells[1]} for ${told[name].cost}`);
    }
    assert.match(await row('fair').innerText(), /proposed/);
    assert.doesNotMatch(await row('dear').innerText(), /proposed/);
    assert.match(await row('tiny').innerText(), /does not fit/);
    await page.getByText('proposed by any').waitFor();
    await page.getByText('It is printed in one piece').waitFor();
    assert.equal(await page.getByLabel('Taking the parts out').count(), 0, 'there is nothing to take apart');
    assert.equal(await page.locator('.part').count(), 0);

    for (const width of ['wide', 'narrow']) {
      const look = await browser.visit(shop.base, { key: shop.key, view: '#/jobs/1', width });
      await look.getByRole('region', { name: 'Why this printer' }).waitFor();
      await assertAccessible(look, `the table, ${width}`);
      await assertNoSideways(look, `the table, ${width}`);
      const lines = (head) => { const range = document.createRange(); range.selectNodeContents(head); return range.getClientRects().length; };
      for (const head of await look.locator('th.share').all()) assert.equal(await head.evaluate(lines), 1, `a share of the cost in one line, ${width}`);
      await screenshot(look, `choice-${width}`);
      await look.context().close();
    }

    const focused = () => page.evaluate(() => document.activeElement?.getAttribute('aria-label') ?? '');
    await page.getByRole('button', { name: /^Approve/ }).waitFor();
    for (let i = 0; i < 60 && !(await focused()).startsWith('Approve'); i += 1) await page.keyboard.press('Tab');
    assert.match(await focused(), /^Approve: job 1/);
    await page.keyboard.press('Enter');
    await page.getByRole('dialog', { name: 'Start printing on fair?' }).waitFor();
    await page.keyboard.press('Tab');
    await page.keyboard.press('Enter');
    await until('it is printed', async () => (await shop.job(1)).state === 'done', 120);
    await page.locator('.job-head').getByText('Printed').waitFor();
    await table.getByText('The cheapest is proposed').waitFor();
    await browser.assertClean();
  });
});
