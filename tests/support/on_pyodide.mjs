// Boots Pyodide, unpacks wheels, imports sympy, and compiles every module of percept_obs; prints seconds of computing.
//     node on_pyodide.mjs PYODIDE WHEEL...
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [core, ...wheels] = process.argv.slice(2);
const computed = () => {
  const { user, system } = process.cpuUsage();
  return (user + system) / 1e6;
};
const began = computed();
const { loadPyodide } = await import(pathToFileURL(`${core}/pyodide.mjs`));
const pyodide = await loadPyodide({ indexURL: `${core}/` });
const booted = computed();
for (const wheel of wheels) pyodide.unpackArchive(new Uint8Array(readFileSync(wheel)), "wheel");
const unpacked = computed();
pyodide.runPython("import sympy; assert str(sympy.sin(1).evalf(3)) == '0.841'");
const imported = computed();
const compiled = pyodide.runPython(`
import sys, warnings
from importlib.util import find_spec
from pathlib import Path
warnings.simplefilter("error")
sources = list(Path(find_spec("percept_obs").origin).parent.rglob("*.py"))
for source in sources:
    compile(source.read_bytes(), source, "exec")
len(sources)`);
const python = pyodide.runPython("sys.version.split()[0]");
console.log(JSON.stringify({ python, boot: booted - began, sympy: imported - unpacked, compiled }));
