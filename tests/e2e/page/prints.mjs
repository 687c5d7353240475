// From a dropped model to a finished print, in the browser alone: the real daemon, the real geometry, simulated printers.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, describe, test } from 'node:test';
import { assertAccessible, assertNoSideways, Browser, drop, missing, screenshot, WIDTHS } from './browser.mjs';
import { bunny, until, Workshop } from './workshop.mjs';

// A machine that asks for its filament before it prints.
const ENDER = `base = "marlin"
name = "Ender with questions"
[slicer]
start_gcode = """
G21
G90
M140 S60
G28
M190 S60
M109 S215
M0 Load the blue filament
G92 E0
"""
`;
const PROGRAM = `G21
G90
M109 S200
G28
G1 X10 Y10 Z0.2 F3000
G1 X60 Y10 E5 F1200
G1 X60 Y60 E10
M104 S0
M84
`;
const PRINTERS = (ports) => `
[printer.ender]
profile = "ender.toml"
port = "${ports.ender}"
size_mm = 40
set = ["min_volume_fraction=0.2", "parts=3"]
[printer.objet]
profile = "objet30"
handoff_folder = "out"
size_mm = 60
set = ["min_volume_fraction=0.1"]
`;

describe('a print', { skip: missing }, () => {
  let shop;
  let browser;
  let page;
  let model;
  let broken = false;
  // Each step goes on from the one before.
  const step = (name, body) => test(name, async (context) => {
    if (broken) return context.skip('an earlier step failed');
    broken = true;
    await body();
    await browser.assertClean();
    broken = false;
  });
  const card = (name) => page.locator(`[data-printer="${name}"].printer`);
  const stateOf = async (id) => (await shop.job(id)).state;
  const isAt = (id, state, patience_s = 120) => until(`job ${id} is ${state}`, async () => {
    const job = await shop.job(id);
    assert.ok(state === 'failed' || job.state !== 'failed', `${job.reason} ${job.hint}`);
    return job.state === state;
  }, patience_s);
  const open = (view) => page.goto(`${shop.base}/${view}`);
  const picture = (which) => page.locator('.scenes canvas').nth(which).screenshot();
  const changes = async (what, which, act) => {
    const before = await picture(which);
    await act();
    await until(what, async () => !(await picture(which)).equals(before), 10);
  };

  before(async () => {
    shop = await Workshop.open({
      printers: PRINTERS, files: { 'ender.toml': ENDER }, settings: '[prepare]\nbudget_s = 2',
      machines: { ender: ['ender.toml', '--speed', '100'] } });
    model = bunny(shop.folder);
    browser = await Browser.open();
    page = await browser.visit(shop.base, { key: shop.key });
  });
  after(async () => {
    await browser?.close();
    await shop?.close();
  });

  step('models are sent by choosing and by dropping', async () => {
    await card('ender').getByText('Bed not clear').waitFor();
    await page.locator('#printer').selectOption('objet');
    await page.locator('input[type=file]').setInputFiles(model);
    await page.locator('.note', { hasText: 'bunny.obj is job 1' }).waitFor();
    await drop(page, [{ name: 'hare.obj', text: readFileSync(model, 'utf8') }], '[data-printer=ender].drop-target');
    await page.locator('[data-job="2"]').waitFor();
    assert.deepEqual((await shop.ask('jobs')).map((job) => job.printer), ['ender', 'objet']);
    await page.locator('[data-job="1"] progress').waitFor();
    await isAt(1, 'ready', 300);
    await page.locator('[data-job="1"]').getByText('Ready to approve').waitFor();
  });

  step('a job is looked at in 3D', async () => {
    await page.locator('[data-job="1"] h3 a').click();
    await page.getByRole('heading', { name: 'bunny.obj' }).waitFor();
    await page.locator('.scenes.drawn').waitFor({ timeout: 60_000 });
    const report = await shop.ask('jobs/1/files/job.json');
    assert.ok(report.parts.length > 1, 'something to take apart');
    assert.equal(await page.locator('.part').count(), report.parts.length);
    const id = report.removal_order[0];
    const part = page.getByRole('button', { name: `Part ${id}`, exact: true });
    for (const which of [0, 1]) {
      await changes(`scene ${which} shows the chosen part`, which, () => part.click());
      assert.equal(await part.getAttribute('aria-pressed'), 'true');
      await page.keyboard.press('Escape');
      assert.equal(await part.getAttribute('aria-pressed'), 'false');
    }
    await page.locator('.scenes canvas').first().click();
    await until('a part is chosen in the picture', async () => (await page.locator('.part[aria-pressed=true]').count()) === 1, 10);
    await page.keyboard.press('Escape');
    for (const key of ['ArrowLeft', 'ArrowUp', '+', '-', 'ArrowRight'])
      await changes(`${key} turns the picture`, 0, () => page.locator('.scenes canvas').first().press(key));
  });

  step('the slider takes the parts out in their order', async () => {
    const { removal_order: order } = await shop.ask('jobs/1/files/job.json');
    const slider = page.getByLabel('Taking the parts out');
    await slider.focus();
    await changes('the first part leaves', 1, () => page.keyboard.press('ArrowRight'));
    await page.getByText(`Step 1 of ${order.length}: part ${order[0]}`).waitFor();
    assert.match(await slider.getAttribute('aria-valuetext'), /^Step 1/);
    await page.keyboard.press('End');
    await page.getByText('The tray is empty').waitFor();
    await page.keyboard.press('Home');
    await page.getByText(`All ${order.length} parts are on the tray`).waitFor();
  });

  step('what it takes is told as the daemon estimates it', async () => {
    const { estimates } = await shop.job(1);
    const row = await page.locator('.estimates tr', { hasText: 'Printing time' }).innerText();
    const hours = Math.floor(estimates.packed.time_s / 3600);
    if (estimates.packed.fits && hours > 0) assert.ok(row.replaceAll('\u00a0', ' ').includes(`${hours} h`), row);
    const titles = (await page.locator('.estimates thead th').allInnerTexts()).map((text) => text.split('\n')[0].trim());
    assert.equal(titles.join(', ').toLowerCase(), 'figure, as it stands, solid, hollow, packed', 'ways that are equal share a column');
    assert.ok((await page.getByRole('button', { name: /^Prepare it (solid|hollow)$/ }).count()) > 0, 'another way can be taken');
    const { advice } = await shop.ask('jobs/1/files/job.json');
    assert.ok(advice.text.length > 0);
    await page.locator('.advice', { hasText: advice.text }).waitFor();
    for (const sum of ['material', 'machine', 'hands']) await page.locator('.estimates th', { hasText: sum }).waitFor();
    const parts = await page.locator('.estimates tr', { hasText: 'Parts' }).locator('td').last().innerText();
    assert.equal(Number(parts), estimates.packed.parts);
  });

  step('every view is for everybody, dark and light, wide and narrow', async () => {
    for (const theme of ['light', 'dark'])
      for (const width of ['wide', 'narrow']) {
        const look = await browser.visit(shop.base, { key: shop.key, theme, width });
        for (const [name, view, sign] of [['now', '#/', '.printer'], ['job', '#/jobs/1', '.scenes.drawn'], ['history', '#/history', 'h1']]) {
          await look.goto(`${shop.base}/${view}`);
          await look.locator(sign).first().waitFor({ timeout: 60_000 });
          await look.waitForTimeout(400);
          await assertAccessible(look, `${name}, ${theme}, ${width}`);
          await assertNoSideways(look, `${name}, ${theme}, ${width}`);
          await screenshot(look, `${name}-${theme}-${width}`);
        }
        await look.context().close();
      }
  });

  step('without WebGL the picture stands in', async () => {
    const flat = await Browser.open({ webgl: false });
    try {
      const look = await flat.visit(shop.base, { key: shop.key, view: '#/jobs/1' });
      await look.locator('.flat img').waitFor({ timeout: 60_000 });
      await look.getByText('draws no 3D').waitFor();
      await look.getByLabel('Taking the parts out').press('ArrowRight');
      await look.getByText('Step 1 of').waitFor();
    } finally {
      await flat.close();
    }
  });

  step('files are kept', async () => {
    const [saved] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Tray, 3MF' }).click()]);
    assert.equal(saved.suggestedFilename(), 'job-1-tray.3mf');
  });

  step('a hand-over is approved, ends in the history and is made again', async () => {
    await page.getByRole('button', { name: /^Approve/ }).click();
    await isAt(1, 'handed_over');
    await page.locator('.job-head').getByText('Handed over').waitFor();
    await page.getByRole('link', { name: 'History' }).click();
    await page.locator('.history [data-job="1"]').getByRole('button', { name: /^Print again/ }).click();
    await page.locator('.note', { hasText: 'queued again' }).waitFor();
    await until('another job', async () => (await shop.ask('jobs'))[0].again_of === 1);
  });

  step('a print waits for its bed, asks, pauses, goes on and is cancelled once', async () => {
    await isAt(2, 'ready', 300);
    await open('#/');
    const row = page.locator('[data-job="2"]');
    await row.getByRole('button', { name: /^Hold/ }).click();
    await row.getByText('Held').waitFor();
    await row.getByRole('button', { name: /^Approve/ }).click();
    await row.getByRole('button', { name: /^The bed of ender is clear/ }).click();
    const question = page.getByRole('dialog', { name: 'Start printing on ender?' });
    await question.getByText(/hare\.obj \(job 2\) starts now on ender\. It takes about \d/).waitFor();
    await assertAccessible(page, 'the question before a print starts');
    for (const width of ['wide', 'narrow']) {
      await page.setViewportSize(WIDTHS[width]);
      await assertNoSideways(page, `the question before a print starts, ${width}`);
      await screenshot(page, `starts-${width}`);
    }
    await page.setViewportSize(WIDTHS.wide);
    await question.getByRole('button', { name: 'Not yet' }).click();
    assert.equal((await shop.ask('printers')).find((one) => one.name === 'ender').bed, 'not clear', 'nothing was said to the printer');
    await row.getByRole('button', { name: /^The bed of ender is clear/ }).click();
    await question.getByRole('button', { name: 'Start the print' }).click();
    await card('ender').getByText('Load the blue filament').waitFor({ timeout: 60_000 });
    await card('ender').getByText(/°C of 2\d\d/).or(card('ender').getByText('215')).first().waitFor();
    assert.match(await page.title(), /^\(\d+\) PackMerger$/, 'the tab tells that somebody is waited for');
    await assertAccessible(page, 'a question');
    await screenshot(page, 'question');
    await card('ender').getByRole('group').getByRole('button').first().click();
    await card('ender').getByText('Printing', { exact: true }).waitFor({ timeout: 30_000 });
    const progress = () => card('ender').locator('progress').evaluate((bar) => bar.value);
    const first = await progress();
    await until('the print gets on', async () => (await progress()) > first);
    await card('ender').getByRole('button', { name: 'Pause ender' }).click();
    await card('ender').getByText('Paused', { exact: true }).waitFor({ timeout: 30_000 });
    await card('ender').getByRole('button', { name: 'Resume ender' }).click();
    await card('ender').getByText('Printing', { exact: true }).waitFor({ timeout: 30_000 });
    await row.getByRole('button', { name: /^Cancel/ }).click();
    await page.getByRole('dialog', { name: 'Cancel job 2?' }).waitFor();
    await assertAccessible(page, 'the question before cancelling');
    assert.equal(await stateOf(2), 'sending', 'asked first');
    await page.getByRole('dialog').getByRole('button', { name: 'Let it print' }).click();
    assert.equal(await stateOf(2), 'sending');
    await row.getByRole('button', { name: /^Cancel/ }).click();
    await page.getByRole('dialog').getByRole('button', { name: 'Cancel the job' }).click();
    await isAt(2, 'cancelled');
    await card('ender').getByText('Bed not clear').waitFor();
  });

  step('what was cancelled is printed again, to its end', async () => {
    await open('#/history');
    await page.locator('.history [data-job="2"]').getByRole('button', { name: /^Print again/ }).click();
    await until('another job', async () => (await shop.ask('jobs'))[0].again_of === 2);
    const { id } = (await shop.ask('jobs'))[0];
    await open(`#/jobs/${id}`);
    await page.getByRole('link', { name: 'job 2' }).waitFor();
    await page.getByRole('button', { name: 'The bed of ender is clear' }).click();
    await page.getByRole('dialog').getByRole('button', { name: 'Start the print' }).click();
    await page.locator('.job-head progress').waitFor();
    await open('#/');
    await card('ender').getByRole('group').getByRole('button').first().click({ timeout: 60_000 });
    await isAt(id, 'done', 300);
    await open('#/history');
    await page.locator(`.history [data-job="${id}"]`).getByText('Printed').waitFor();
    await open(`#/jobs/${id}`);
    await page.locator('.timeline', { hasText: 'Printed' }).waitFor();
    await page.locator('.scenes.drawn').waitFor({ timeout: 60_000 });
    await screenshot(page, 'done');
  });

  step('a program of another slicer is shown for what it is', async () => {
    const { id } = await shop.upload('ender', 'cube.gcode', PROGRAM);
    await isAt(id, 'ready');
    await open(`#/jobs/${id}`);
    await page.locator('.job-head').getByText('a program, printed as it is').waitFor();
    await page.getByRole('button', { name: 'Program, gcode' }).waitFor();
    assert.equal(await page.locator('.scenes').count(), 0, 'there is nothing to take apart');
    assert.equal(await page.locator('.estimates thead th').count(), 2);
    await assertAccessible(page, 'a program');
    await screenshot(page, 'program');
    await open('#/');
    await page.locator(`[data-job="${id}"]`).getByText('Ready to approve').waitFor();
  });
});
