// Printed texts of the page: unpacked when a lab opens, parsed part by part when needed.

/** @returns {Promise<Record<string, any>>} a lab's model: its printed texts, and the data from Python */
export async function modelOf(texts, given) {
  const unpacked = new Blob([texts]).stream().pipeThrough(new DecompressionStream("gzip"));
  const [shared, ...rows] = (await new Response(unpacked).text()).split("\n");
  const lines = JSON.parse(shared);
  const whole = (_, value) => value?.["\n"]?.map((number) => lines[number]).join("\n") ?? value;
  const model = {};
  for (const row of rows) {
    const tab = row.indexOf("\t");
    const [group, name] = row.slice(0, tab).split("/");
    const read = () => JSON.parse(row.slice(tab + 1), whole);
    if (name === undefined) Object.assign(model, read());
    else lazily((model[group] ??= {}), name, read);
  }
  return Object.assign(model, given);
}

/** A text with values in the places of their names. */
export function filled(text, values) {
  return text.replace(/{(\w+)}/g, (_, name) => values[name]);
}

/** A property that is made when it is first asked for. */
function lazily(object, name, make) {
  const set = (value) => Object.defineProperty(object, name, { value, enumerable: true });
  Object.defineProperty(object, name, { get: () => set(make())[name], enumerable: true, configurable: true });
}
