// Search in pages that are opened from disk, where browsers allow no worker: runs the script of
// the worker in a hidden frame instead.
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(script) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      document.body.append(frame);
      this.inside = frame.contentWindow;
      this.waiting = [];
      const element = frame.contentDocument.createElement("script");
      element.src = script;
      element.onload = () => {
        this.waiting.forEach((message) => this.deliver(message));
        this.waiting = null;
      };
      this.inside.postMessage = (data) =>
        this.dispatchEvent(new MessageEvent("message", { data }));
      frame.contentDocument.body.append(element);
    }

    postMessage(data) {
      if (this.waiting) this.waiting.push(data);
      else this.deliver(data);
    }

    deliver(data) {
      const message = new this.inside.MessageEvent("message", { data });
      this.inside.dispatchEvent(message);
    }

    terminate() {
      this.inside.frameElement.remove();
    }

    set onmessage(listener) {
      this.addEventListener("message", listener);
    }
  };
}
