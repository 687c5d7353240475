// The page is built into a folder that the daemon serves; its Content-Security-Policy allows files
// of its own host and nothing inline.
import { readFileSync } from 'node:fs';
import { defineConfig } from 'vite';

const PARTS = ['three', 'preact', '@fontsource-variable/inter'];

// The licences of what the page is made of, as a file beside it.
const licences = {
  name: 'licences',
  generateBundle() {
    const texts = PARTS.map((part) =>
      `${part}\n\n${readFileSync(new URL(`../../node_modules/${part}/LICENSE`, import.meta.url), 'utf8')}`);
    this.emitFile({ type: 'asset', fileName: 'licences.txt', source: texts.join(`\n${'-'.repeat(72)}\n\n`) });
  },
};

export default defineConfig({
  plugins: [licences],
  esbuild: { jsx: 'automatic', jsxImportSource: 'preact', legalComments: 'none' },
  build: {
    target: 'es2022',
    modulePreload: { polyfill: false },
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 800,
    reportCompressedSize: false,
  },
});
