// @ts-check
// The latest result of settings that a hand moves: found here, or in a worker, where one task at a time is under way.

/** @typedef {{settings: any, whole: boolean}} Task  whose result is wanted, whole or as far as it is always drawn */

/** The latest result.  Once there is a worker, of all tasks that wait only the latest is sent. */
export class Latest {
  constructor(results, onFound) {
    this.results = results;
    this.onFound = onFound;
    /** @type {any} */
    this.shown = null;
    /** @type {any} */
    this.ghost = null;
    /** @type {{ask: (task: Task) => void} | null} */
    this.beside = null;
    /** @type {Task | null} */
    this.asked = null;
    /** @type {Task | null} */
    this.waiting = null;
    /** @type {((answer: {error?: string}) => void)[]} */
    this.listeners = [];
  }

  /** True if the latest result is of these settings. */
  has({ settings, whole }) {
    return this.shown?.settings === settings && (this.shown.whole || !whole);
  }

  /** Find what is shown of settings, and say whether it is there; if it is not, `onFound` is called when it is. */
  want(settings, whole) {
    const task = { settings, whole };
    if (this.has(task)) return true;
    if (!this.beside) {
      Object.assign(this, this.results.of(settings, whole));
      return true;
    }
    const { asked, waiting } = this;
    const answers = (other) => other?.settings === settings && (other.whole || !whole);
    if (answers(asked)) this.waiting = null;
    else if (!answers(waiting)) this.waiting = task;
    this.send();
    return false;
  }

  send() {
    if (this.asked || !this.waiting || !this.beside) return;
    [this.asked, this.waiting] = [this.waiting, null];
    this.beside.ask(this.asked);
  }

  /**
   * Take an answer from beside the page; without a new ghost the last one stays.
   *
   * @param {{error?: string, shown?: any, ghost?: any}} answer
   */
  take({ error, shown, ...more }) {
    if (!this.asked) return;
    const { settings } = this.asked;
    this.asked = null;
    if (shown) this.shown = { ...shown, settings };
    if ("ghost" in more) this.ghost = more.ghost && { ...more.ghost, settings: settings.kept };
    if (this.waiting && this.has(this.waiting)) this.waiting = null;
    this.send();
    this.onFound(error);
    for (const listener of this.listeners.splice(0)) listener({ error });
  }

  /** Wait for the next answer; an error if that is none. */
  async next() {
    const { error } = await new Promise((resolve) => this.listeners.push(resolve));
    if (error) throw new Error(error);
  }

  /** The worker is gone: from now on the page computes. */
  lose() {
    this.beside = this.waiting = null;
    if (this.asked) this.take({});
  }
}
