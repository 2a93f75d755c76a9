// Validates glTF files: `node validate.cjs FOLDER-OF-GLTF-VALIDATOR FILE...` prints a line for each
// error and each warning, and how many files were read.

const fs = require("fs");
const path = require("path");

const [folder, ...files] = process.argv.slice(2);
const validator = require(folder);
const SEVERITIES = ["error", "warning"];

async function validate(file) {
  const beside = async (uri) =>
    new Uint8Array(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri))));
  const options = { maxIssues: 0, externalResourceFunction: beside };
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), options);
  for (const { severity, code, message, pointer } of report.issues.messages) {
    if (severity < SEVERITIES.length) {
      console.log(`${path.basename(file)}: ${SEVERITIES[severity]} ${code} ${pointer}: ${message}`);
    }
  }
}

(async () => {
  for (const file of files) {
    await validate(file);
  }
  console.log(`${files.length} files`);
})();
