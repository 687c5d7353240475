// node validate_gltf.js FILE.glb …: the Khronos validator on each. Exits 0, 1 with what is wrong, or 77 where the
// npm package gltf-validator is not installed.
'use strict';

const fs = require('fs');
const path = require('path');

let validator;
try {
  const root = path.join(__dirname, '..', '..', 'node_modules');
  validator = require(require.resolve('gltf-validator', {paths: [root, process.cwd()]}));
} catch (error) {
  console.error(error.message);
  process.exit(77);
}

async function validate(file) {
  const {issues} = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)));
  for (const message of issues.messages.filter((m) => m.severity <= 1)) {
    console.log(`${file}: ${message.code} at ${message.pointer}: ${message.message}`);
  }
  return issues.numErrors + issues.numWarnings;
}

Promise.all(process.argv.slice(2).map(validate)).then(
    (counts) => process.exit(counts.some((count) => count > 0) ? 1 : 0),
    (error) => {
      console.error(error);
      process.exit(1);
    });
