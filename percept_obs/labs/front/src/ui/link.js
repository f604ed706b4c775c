// The page's line to Python: state goes out when the hand rests, at most one message at a time, the latest wins.

const PATIENCE = 4000;

/** Sends settings and summary, hears what Python adds to them, and tells when Python does not answer. */
export class Link {
  constructor(widget, { onSettings, onView, onAnalysis, onError, onSilence }) {
    this.widget = widget;
    /** @type {{settings: any, serial: number} | null} */
    this.sent = null;
    this.waitingFor = null;
    this.onSilence = onSilence;
    this.listeners = {
      "change:settings": () => onSettings(widget.get("settings")),
      "change:view": () => onView(widget.get("view")),
      "change:error": () => onError(widget.get("error")),
      "change:analysis": () => this.heard(widget.get("analysis"), onAnalysis),
    };
    for (const [event, listener] of Object.entries(this.listeners)) widget.on(event, listener);
  }

  send(settings, summary, view = null) {
    this.widget.set("settings", settings);
    if (view) this.widget.set("view", view);
    this.widget.set("summary", summary);
    this.sent = { settings, serial: summary.serial };
    if (!this.widget.save_changes) return;
    try {
      this.widget.save_changes();
    } catch (error) {
      this.onSilence(error);
    }
    clearTimeout(this.timer);
    this.waitingFor = summary.serial;
    this.timer = setTimeout(() => this.waitingFor !== null && this.onSilence(null), PATIENCE);
  }

  /** An answer is about the settings that were sent with its serial; one to others is too late. */
  heard(analysis, onAnalysis) {
    if (!this.sent || analysis.serial !== this.sent.serial) return;
    this.waitingFor = null;
    clearTimeout(this.timer);
    this.onSilence(undefined);
    onAnalysis(analysis, this.sent.settings);
  }

  close() {
    clearTimeout(this.timer);
    for (const [event, listener] of Object.entries(this.listeners)) this.widget.off(event, listener);
  }
}
