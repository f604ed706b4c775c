// A page without a browser: elements, canvases that write down what is drawn, and a clock that the test moves.

const VOID = new Set(["mspace", "br", "img"]);
/** Sizes of what the page measures; everything stands at the upper left. */
const SIZES = { view: [420, 280], "over-time": [760, 150], motion: [520, 300], misses: [640, 120] };
/** One pixel in so many parts: what two machines round differently is the same here. */
const PARTS = 50;

/** Attributes that are numbered as elements are made, or told as states; and states. */
const UNTOLD = new Set(["id", "for", "aria-describedby", "hidden", "disabled", "value"]);
const STATE = ["hidden", "disabled", "checked", "open", "value", "ariaInvalid", "tabIndex"];

const camel = (name) => name.replace(/-([a-z])/g, (_, letter) => letter.toUpperCase());
const written = (value) => {
  if (typeof value === "number") return String(Math.round(value * PARTS) / PARTS + 0);
  if (Array.isArray(value)) return `[${value.map(written)}]`;
  return value instanceof Trace ? `{${value.told().join("; ")}}` : String(value);
};

/** Whatever is called or set on it is written down: a pen of a canvas, or a path. */
class Trace {
  /** @type {[string, any][]} */
  calls = [];

  told() {
    return this.calls.map(([name, given]) => (Array.isArray(given) ? `${name}(${given.map(written)})` : `${name} = ${given}`));
  }

  static made() {
    const trace = new Trace();
    const state = { measureText: (text) => ({ width: 6 * text.length }), told: () => trace.told() };
    const call = (name) => (...given) => {
      if (name === "clearRect") trace.calls = [];
      trace.calls.push([name, given]);
    };
    return new Proxy(trace, {
      get: (_, name) => (state[name] ??= call(name)),
      set: (_, name, value) => {
        if (state[name] !== value) trace.calls.push([name, written(value)]);
        state[name] = value;
        return true;
      },
    });
  }
}

/** One step of a selector, such as `button.link[data-control^="a"]`, and whether a node is what it says. */
function isSuch(node, step) {
  const parts = step.match(/^[\w-]+|\.[\w-]+|#[\w-]+|\[[^\]]+\]/g);
  return parts.every((part) => {
    if (part[0] === ".") return node.classList.contains(part.slice(1));
    if (part[0] !== "[") return node.tagName.toLowerCase() === part;
    const [, name, , how, , value] = /^\[([\w-]+)((\^?=)(["']?)(.*?)\4)?\]$/.exec(part);
    const there = node.getAttribute(name);
    return how === "^=" ? there?.startsWith(value) : how ? there === value : there !== null;
  });
}

class Element {
  constructor(tag) {
    this.tagName = tag;
    this.attributes = {};
    this.childNodes = [];
    this.parentElement = null;
    this.listeners = {};
    this.style = { setProperty: (name, value) => (this.style[name] = value) };
    const names = () => new Set((this.attributes.class ?? "").split(" ").filter(Boolean));
    const put = (change) => {
      const now = names();
      change(now);
      this.attributes.class = [...now].join(" ");
    };
    this.classList = {
      contains: (name) => names().has(name),
      add: (...added) => put((now) => added.forEach((name) => now.add(name))),
      remove: (...gone) => put((now) => gone.forEach((name) => now.delete(name))),
      toggle: (name, on = !names().has(name)) => put((now) => (on ? now.add(name) : now.delete(name))),
    };
    this.dataset = new Proxy({}, {
      get: (_, name) => this.attributes[`data-${name.replace(/[A-Z]/g, (c) => `-${c.toLowerCase()}`)}`],
      set: (_, name, value) => {
        this.attributes[`data-${name}`] = String(value);
        return true;
      },
    });
    if (tag === "canvas") this.pen = Trace.made();
  }

  getContext() {
    return this.pen;
  }

  setAttribute(name, value) {
    this.attributes[name] = String(value);
    if (["value", "checked", "disabled", "hidden", "type", "min", "max", "step", "id", "tabindex"].includes(name))
      this[name] = name === "hidden" || name === "checked" || name === "disabled" ? true : String(value);
  }

  getAttribute(name) {
    return this.attributes[name] ?? null;
  }

  removeAttribute(name) {
    delete this.attributes[name];
  }

  get className() {
    return this.attributes.class ?? "";
  }

  set className(value) {
    this.attributes.class = value;
  }

  get children() {
    return this.childNodes.filter((child) => child instanceof Element);
  }

  get options() {
    return this.querySelectorAll("option");
  }

  get lastChild() {
    return this.childNodes.at(-1) ?? null;
  }

  get textContent() {
    return this.childNodes.map((child) => (child instanceof Element ? child.textContent : child)).join("");
  }

  set textContent(text) {
    this.replaceChildren(...(text === "" ? [] : [text]));
  }

  set innerHTML(text) {
    this.replaceChildren();
    let at = /** @type {any} */ (this);
    for (const [, close, tag, given, words] of text.matchAll(/<(\/?)([\w-]+)([^>]*)>|([^<]+)/g)) {
      if (words !== undefined) at.append(words.replaceAll("&InvisibleTimes;", "\u2062").replaceAll("&nbsp;", "\u00a0"));
      else if (close) at = at.parentElement;
      else {
        const node = new Element(tag);
        for (const [, name, value] of given.matchAll(/([\w-]+)="([^"]*)"/g)) node.setAttribute(name, value);
        at.append(node);
        if (!given.endsWith("/") && !VOID.has(tag)) at = node;
      }
    }
  }

  insert(at, nodes) {
    for (const node of nodes) if (node instanceof Element) node.remove();
    this.childNodes.splice(at, 0, ...nodes.map((node) => (node instanceof Element ? node : String(node))));
    for (const node of nodes) if (node instanceof Element) node.parentElement = this;
  }

  append(...nodes) {
    this.insert(this.childNodes.length, nodes);
  }

  prepend(...nodes) {
    this.insert(0, nodes);
  }

  before(...nodes) {
    this.parentElement.insert(this.parentElement.childNodes.indexOf(this), nodes);
  }

  after(...nodes) {
    this.parentElement.insert(this.parentElement.childNodes.indexOf(this) + 1, nodes);
  }

  replaceChildren(...nodes) {
    for (const child of this.children) child.parentElement = null;
    this.childNodes = [];
    this.append(...nodes);
  }

  remove() {
    if (!this.parentElement) return;
    this.parentElement.childNodes.splice(this.parentElement.childNodes.indexOf(this), 1);
    this.parentElement = null;
  }

  matches(selector) {
    return selector.split(",").some((each) => {
      const [last, ...outer] = each.trim().match(/(\[[^\]]*\]|[^\s[])+/g).reverse();
      return isSuch(this, last) && outer.every((step) => this.parentElement?.closest(step));
    });
  }

  closest(selector) {
    return this.matches(selector) ? this : (this.parentElement?.closest(selector) ?? null);
  }

  querySelectorAll(selector) {
    return this.children.flatMap((child) => [...(child.matches(selector) ? [child] : []), ...child.querySelectorAll(selector)]);
  }

  querySelector(selector) {
    return this.querySelectorAll(selector)[0] ?? null;
  }

  contains(node) {
    return node === this || Boolean(node?.parentElement && this.contains(node.parentElement));
  }

  /** True if nothing around it is hidden or folded. */
  get seen() {
    if (this.hidden) return false;
    const folded = this.parentElement?.tagName === "details" && !this.parentElement.open && this.tagName !== "summary";
    return !folded && (this.parentElement?.seen ?? true);
  }

  sizeOf() {
    const name = Object.keys(SIZES).findLast((each) => this.classList.contains(each));
    return this.seen && name ? SIZES[name] : [0, 0];
  }

  get scrollHeight() {
    return 20;
  }

  get clientWidth() {
    return this.sizeOf()[0];
  }

  get clientHeight() {
    return this.sizeOf()[1];
  }

  getBoundingClientRect() {
    const [width, height] = this.sizeOf();
    return { left: 0, top: 0, right: width, bottom: height, width, height };
  }

  addEventListener(type, listener) {
    (this.listeners[type] ??= []).push(listener);
  }

  removeEventListener(type, listener) {
    this.listeners[type] = this.listeners[type]?.filter((each) => each !== listener);
  }

  /** Tell a node and all around it of an event; returns the event. */
  tell(type, more = {}) {
    const event = { type, target: this, defaultPrevented: false, button: 0, pointerId: 1, pointerType: "mouse", ...more };
    let stopped = false;
    Object.assign(event, { preventDefault: () => (event.defaultPrevented = true), stopPropagation: () => (stopped = true) });
    for (let node = /** @type {any} */ (this); node && !stopped; node = node.parentElement) {
      for (const listener of node.listeners[type] ?? []) listener.call(node, event);
    }
    return event;
  }

  focus() {
    document.activeElement?.blur?.();
    document.activeElement = this;
    for (const type of ["focus", "focusin"]) this.tell(type);
  }

  blur() {
    if (document.activeElement !== this) return;
    document.activeElement = document.body;
    for (const type of ["blur", "focusout"]) this.tell(type);
  }

  scrollIntoView() {}

  setPointerCapture() {}

  /** What a reader, a hand and an eye find here, a line for each thing. */
  told(indent = "", lines = []) {
    const words = [`${indent}${this.tagName}`];
    for (const [name, value] of Object.entries(this.attributes)) if (!UNTOLD.has(name)) words.push(`${name}=${value}`);
    for (const name of STATE) if (this[name] !== undefined && this[name] !== false) words.push(`${name}=${this[name]}`);
    for (const [name, value] of Object.entries(this.style)) if (typeof value === "string") words.push(`${name}: ${value}`);
    lines.push(words.join(" "));
    if (this.hidden) return lines;
    for (const stroke of this.pen?.told() ?? []) lines.push(`${indent} ${stroke}`);
    for (const child of this.childNodes) {
      if (child instanceof Element) child.told(`${indent} `, lines);
      else lines.push(`${indent} "${child}"`);
    }
    return lines;
  }
}
for (const name of ["aria-label", "aria-pressed"])
  Object.defineProperty(Element.prototype, camel(name), {
    get() {
      return this.attributes[name];
    },
    set(value) {
      this.setAttribute(name, value);
    },
  });

let document;

/** Make the page's globals anew; returns what moves its clock. */
export function openPage({ still = false, hash = "" } = {}) {
  let now = 1000;
  let next = 1;
  let waiting = [];
  const later = (act, wait = 0) => waiting.push({ id: next, at: now + wait, act }) && next++;
  const forget = (id) => (waiting = waiting.filter((each) => each.id !== id));
  const media = (query) => ({ matches: still && query.includes("motion"), addEventListener() {}, removeEventListener() {} });
  class Unseen {
    observe() {}
    disconnect() {}
  }
  class Seen extends Unseen {
    constructor(act) {
      super();
      this.act = act;
    }

    observe(target) {
      later(() => this.act([{ isIntersecting: true, target }]));
    }
  }
  const listeners = {};
  const window = {
    ...{ matchMedia: media, devicePixelRatio: 1, location: { hash, protocol: "file:", href: `file:///lab.html${hash}` } },
    addEventListener: (type, act) => (listeners[type] ??= []).push(act),
    removeEventListener: (type, act) => (listeners[type] = listeners[type].filter((each) => each !== act)),
    history: { state: null, replaceState: (_, __, to) => (window.location.hash = to) },
  };
  document = { body: new Element("body"), createElement: (tag) => new Element(tag), createElementNS: (_, tag) => new Element(tag) };
  document.activeElement = document.body;
  const copied = [];
  const globals = {
    ...{ window, document, ResizeObserver: Unseen, MutationObserver: Unseen, IntersectionObserver: Seen },
    Path2D: function () {
      return Trace.made();
    },
    navigator: { clipboard: { writeText: async (text) => copied.push(text) } },
    getComputedStyle: () => ({ getPropertyValue: (name) => name.replace("--lab-", "") }),
    setTimeout: later,
    clearTimeout: forget,
    requestAnimationFrame: (act) => later(act, 16),
    cancelAnimationFrame: forget,
    performance: { now: () => now },
  };
  for (const [name, value] of Object.entries(globals))
    Object.defineProperty(globalThis, name, { value, configurable: true, writable: true });
  /** Let so many milliseconds pass. */
  const pass = (wait) => {
    const end = now + wait;
    for (;;) {
      const [first] = waiting.filter(({ at }) => at <= end).sort((a, b) => a.at - b.at || a.id - b.id);
      if (!first) break;
      forget(first.id);
      now = Math.max(now, first.at);
      first.act();
    }
    now = end;
  };
  /** Follow a link within the page. */
  const go = (to) => {
    window.location.hash = to;
    for (const act of listeners.hashchange ?? []) act();
  };
  return { document, window, copied, pass, go, told: () => document.body.told() };
}
