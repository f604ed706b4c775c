/** Import a module's text in Node, which knows no addresses of Blobs. */
export function loadHere(text) {
  return import(`data:text/javascript;charset=utf-8,${encodeURIComponent(text)}`);
}
