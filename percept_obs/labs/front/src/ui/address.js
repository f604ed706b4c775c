// @ts-check
// A lab's part of the page's address, where the page opens without Python: read when the page opens or its address
// changes, and written when the hand rests; it replaces the address, so that "back" leads to the page before.

import { BadAddress, fragmentOf, isTooLong, MOST, partsOf, settingsIn, textOf } from "../state/address.js";
import { same } from "../state/settings.js";

/** Milliseconds between changes of the address: browsers refuse more than a hundred in half a minute. */
const SELDOM = 500;
const UNCHANGED = "The lab is as it would be without the link.";

export class Address {
  /** @param {{name: string, names: string[]}} place  the lab's name in the address, and those of all the page's labs */
  constructor(lab, place) {
    this.lab = lab;
    this.name = place.name;
    this.names = place.names;
    /** The settings in the address; those that the lab opens with need not be there. */
    this.written = lab.settings;
    this.looked = lab.state.view;
    this.timer = /** @type {any} */ (null);
    this.listener = () => this.follow();
    window.addEventListener("hashchange", this.listener);
  }

  /** Take what the address says of this lab; what cannot be taken leaves the lab as it is. */
  async follow() {
    const { lab, name, names } = this;
    const { hash } = window.location;
    clearTimeout(this.timer);
    this.timer = null;
    try {
      const parts = partsOf(hash);
      const mine = parts.get(name);
      if (mine === undefined) {
        // The first lab tells of an address that is about none of them.
        if (names[0] === name) this.refuseStranger(hash, [...parts.keys()]);
        return;
      }
      const { settings, view } = this.read(mine);
      for (const each of lab.wanted(settings)) await this.refuse(each);
      // Meanwhile another lab may have written its own part of the address.
      if (lab.closed || partsOf(window.location.hash).get(name) !== mine) return;
      lab.visit(settings, view);
      if (parts.keys().next().value === name) lab.view.root.scrollIntoView({ block: "nearest" });
    } catch (error) {
      if (!(error instanceof BadAddress)) return lab.fail(error);
      const why = error.message.replace(/\.$/, "");
      lab.view.notice(`The link in this page's address is not followed: ${why}. ${UNCHANGED}`);
    }
  }

  refuseStranger(hash, found) {
    const { names } = this;
    if (isTooLong(hash)) throw new BadAddress(`it has ${hash.length} letters, and a lab reads ${MOST} at most`);
    if (!found.length || found.some((name) => names.includes(name))) return;
    throw new BadAddress(`it is about "${found[0].slice(0, 40)}", and this page has ${names.join(", ")}`);
  }

  /** Refuse settings that do not go together, or that the page has no functions for. */
  async refuse(settings) {
    const { lab } = this;
    const why = lab.fitted(settings).why || lab.clash(settings);
    if (why) throw new BadAddress(why);
    const lacking = lab.kernels.needed(settings).find(({ refusal }) => refusal);
    if (lacking) throw new BadAddress(lacking.refusal);
    await lab.kernels.prepare(settings);
    for (const [observer, gains] of Object.entries(settings.gains ?? {})) {
      const standard = lab.model.standard.gains[observer];
      const allowed = (gain) => same(gains[gain], standard[gain]) || lab.kernels.allows(observer, gain, gains[gain]);
      const bad = Object.keys(gains).find((gain) => !allowed(gain));
      if (bad) throw new BadAddress(`"gains.${observer}.${bad}" is ${gains[bad]}, which this observer does not allow`);
    }
  }

  /** What the address tells as settings is also how they are looked at. */
  get told() {
    const { schema, standard, view } = this.lab.model;
    const kinds = { ...schema, look: { kind: "group", of: view.schema } };
    return { schema: kinds, standard: { ...standard, look: view.standard } };
  }

  read(text) {
    const { look, kept, ...settings } = settingsIn(text, this.told);
    if (kept) delete kept.look;
    return { settings: { ...settings, kept }, view: look };
  }

  text(settings, view) {
    const kept = settings.kept && { ...settings.kept, look: view };
    return textOf({ ...settings, kept, look: view }, this.told);
  }

  /** Settings have come to rest. */
  rested(settings, view) {
    if (settings === this.written && view === this.looked) return;
    this.written = settings;
    this.looked = view;
    this.timer ??= setTimeout(() => this.write(), SELDOM);
  }

  write() {
    this.timer = null;
    const parts = [...partsOf(window.location.hash)].filter(([name]) => this.names.includes(name));
    const all = new Map(parts).set(this.name, this.text(this.written, this.looked));
    window.history.replaceState(window.history.state, "", fragmentOf(all));
  }

  /** The address of the page with this lab as it is now, and no other. */
  link() {
    const [page] = window.location.href.split("#");
    return page + fragmentOf(new Map([[this.name, this.text(this.lab.settings, this.lab.state.view)]]));
  }

  close() {
    clearTimeout(this.timer);
    window.removeEventListener("hashchange", this.listener);
  }
}
