// Elements of the page.  Text is written only where it changes, for each change makes the page lay itself out.

/** Make an element: attributes, listeners as "onclick", then children. */
export function element(tag, attributes = {}, ...children) {
  return filled(document.createElement(tag), attributes, children);
}

/** Make an element of a vector graphic. */
export function svg(tag, attributes = {}, ...children) {
  return filled(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

function filled(node, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (value === true) node.setAttribute(key, "");
    else if (value !== false && value !== undefined && value !== null) node.setAttribute(key, value);
  }
  node.append(...children);
  return node;
}

export function button(text, onclick, attributes = {}) {
  return element("button", { type: "button", onclick, ...attributes }, text);
}

/** Add listeners to a node by the names of events; a listener may stand for several: "pointerup pointercancel". */
export function listen(node, listeners) {
  for (const [types, listener] of Object.entries(listeners)) {
    for (const type of types.split(" ")) node.addEventListener(type, listener);
  }
}

/** Make an element that holds a formula in MathML. */
export function formula(tag, text, attributes = {}, display = false) {
  const node = element(tag, attributes);
  node.innerHTML = `<math${display ? ' displaystyle="true"' : ""}>${text}</math>`;
  return node;
}

export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** Set a text, and hide its element while it is empty. */
export function setOptionalText(node, text) {
  setText(node, text);
  node.hidden = !text;
}

export function setAttribute(node, name, value) {
  if (node.getAttribute(name) !== value) node.setAttribute(name, value);
}

/** Set the items of a list, each a text. */
export function setItems(list, texts) {
  texts.forEach((text, k) => {
    if (!list.children[k]) list.append(element("li"));
    setText(list.children[k], text);
  });
  while (list.children.length > texts.length) list.lastChild.remove();
}
