// The page's line to Python: state goes out when the hand rests, at most one message at a time, the latest wins.

const PATIENCE = 4000;

/** Sends settings and summary, and tells when Python does not answer. */
export class Link {
  constructor(model, { onSettings, onAnalysis, onError, onSilence }) {
    this.model = model;
    this.serial = 0;
    this.waitingFor = null;
    this.listeners = {
      "change:settings": () => onSettings(model.get("settings")),
      "change:error": () => onError(model.get("error")),
      "change:analysis": () => this.heard(model.get("analysis"), onAnalysis, onSilence),
    };
    for (const [event, listener] of Object.entries(this.listeners)) model.on(event, listener);
    this.onSilence = onSilence;
  }

  /** Hand the latest state over. */
  send(settings, summary) {
    this.model.set("settings", settings);
    this.model.set("summary", summary);
    try {
      this.model.save_changes();
    } catch (error) {
      this.onSilence(error);
    }
    clearTimeout(this.timer);
    this.waitingFor = summary.serial;
    this.timer = setTimeout(() => this.waitingFor !== null && this.onSilence(null), PATIENCE);
  }

  heard(analysis, onAnalysis, onSilence) {
    if (analysis.of !== this.waitingFor && this.waitingFor !== null) return;
    this.waitingFor = null;
    clearTimeout(this.timer);
    onSilence(undefined);
    onAnalysis(analysis);
  }

  close() {
    clearTimeout(this.timer);
    for (const [event, listener] of Object.entries(this.listeners)) this.model.off(event, listener);
  }
}
