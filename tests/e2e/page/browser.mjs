// Debian's Chromium, and a watch over everything a page must not do.
import AxeBuilder from '@axe-core/playwright';
import { chromium } from 'playwright-core';
import assert from 'node:assert/strict';
import { existsSync, mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { SCREENSHOTS } from './workshop.mjs';

export const WIDTHS = { wide: { width: 1280, height: 860 }, narrow: { width: 360, height: 740 } };
const PATIENCE_MS = 20_000;
const CHROMIUM = '/usr/bin/chromium';
// what Chromium itself says of a refused request; every test that causes one also asserts it
const HARMLESS = /^Failed to load resource: (the server responded with a status of|net::ERR_)/;

export const missing = existsSync(CHROMIUM) ? false : 'chromium is not installed';

export class Browser {
  visits = [];

  static async open({ webgl = true } = {}) {
    const browser = new Browser();
    const gl = webgl ? ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] : ['--disable-gpu', '--disable-3d-apis'];
    browser.chromium = await chromium.launch({ executablePath: CHROMIUM, args: ['--no-sandbox', ...gl] });
    return browser;
  }

  // A page of its own, without what other pages keep. key: as if it had been pasted before.
  async visit(base, { view = '#/', key = '', width = 'wide', theme = 'light', calm = true } = {}) {
    const context = await this.chromium.newContext({
      viewport: WIDTHS[width], colorScheme: theme, reducedMotion: calm ? 'reduce' : 'no-preference', acceptDownloads: true });
    context.setDefaultTimeout(PATIENCE_MS);
    const page = await context.newPage();
    const wrong = [];
    const host = new URL(base).host;
    page.on('request', (request) => {
      const url = new URL(request.url());
      if (url.protocol !== 'blob:' && url.protocol !== 'data:' && url.host !== host) wrong.push(`asks ${url.href}`);
    });
    page.on('pageerror', (error) => wrong.push(`fails: ${error.message}`));
    page.on('console', (message) => {
      if (['error', 'warning'].includes(message.type()) && !HARMLESS.test(message.text()) && !message.text().includes('GPU stall'))
        wrong.push(`says: ${message.text()}`);
    });
    await page.addInitScript((kept) => {
      window.violations = [];
      document.addEventListener('securitypolicyviolation', (event) => window.violations.push(event.violatedDirective));
      if (kept) sessionStorage.setItem('packmerger-key', kept);
    }, key);
    this.visits.push({ page, wrong });
    await page.goto(`${base}/${view}`);
    return page;
  }

  async assertClean() {
    for (const { page, wrong } of this.visits) {
      assert.deepEqual(wrong, [], 'what the page must not do');
      if (!page.isClosed()) assert.deepEqual(await page.evaluate(() => window.violations), []);
    }
  }

  close() {
    return this.chromium.close();
  }
}

// Nothing that axe calls serious or critical.
export async function assertAccessible(page, what) {
  const { violations } = await new AxeBuilder({ page }).analyze();
  const serious = violations.filter(({ impact }) => impact === 'serious' || impact === 'critical');
  assert.deepEqual(serious.map((one) => `${one.id}: ${one.nodes.map((node) => node.html).join('\n')}`), [], what);
}

export async function assertNoSideways(page, what) {
  const [wanted, given] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(wanted <= given, `${what}: ${wanted} px wide in a window of ${given}`);
}

export async function screenshot(page, name) {
  mkdirSync(SCREENSHOTS, { recursive: true });
  await page.evaluate(() => scrollTo(0, 0));
  await page.screenshot({ path: join(SCREENSHOTS, `${name}.png`), fullPage: true });
}

// Files dropped on what the selector names, as a person's hand would.
export async function drop(page, files, selector) {
  const data = await page.evaluateHandle((list) => {
    const transfer = new DataTransfer();
    for (const { name, text } of list) transfer.items.add(new File([text], name));
    return transfer;
  }, files);
  await page.dispatchEvent('body', 'dragenter', { dataTransfer: data });
  await page.dispatchEvent('body', 'dragover', { dataTransfer: data });
  await page.dispatchEvent(selector, 'dragenter', { dataTransfer: data });
  await page.dispatchEvent(selector, 'drop', { dataTransfer: data });
}
