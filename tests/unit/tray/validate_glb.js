// node validate_glb.js PACKAGE_FOLDER FILE...: prints the Khronos validator's findings as JSON, an
// array with one report per file.
const fs = require('fs');
const [folder, ...files] = process.argv.slice(2);
const validator = require(folder + '/gltf-validator');

Promise.all(files.map((file) => validator.validateBytes(new Uint8Array(fs.readFileSync(file)))))
    .then((reports) => console.log(JSON.stringify(reports.map((report) => report.issues))))
    .catch((error) => {
      console.error(error);
      process.exit(1);
    });
