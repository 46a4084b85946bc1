// The dialog that opens a design file, a text or a link; what is wrong with it is said with line and key.

import { make, note } from "./elements.js";
import { Store } from "./store.js";

export class Opener {
  constructor(app) {
    this.app = app;
    const get = (id) => document.getElementById(id);
    this.dialog = get("opener");
    this.text = get("opener-text");
    this.list = get("opener-problems");
    get("opener-go").addEventListener("click", () => this.#open());
    get("opener-cancel").addEventListener("click", () => this.dialog.close());
    get("opener-file").addEventListener("change", (event) => this.#read(event.target.files[0]));
    document.addEventListener("dragover", (event) => event.preventDefault());
    document.addEventListener("drop", (event) => {
      event.preventDefault();
      const [file] = event.dataTransfer.files;
      if (!file) return;
      if (/\.(wav|flac|ogg|csv|npy|uff|unv)$/i.test(file.name)) return this.app.panels.get("recording")?.take(file);
      this.show();
      this.#read(file);
    });
  }

  show() {
    this.name = null;
    this.list.replaceChildren();
    if (!this.dialog.open) this.dialog.showModal();
  }

  async #read(file) {
    if (!file) return;
    if (file.size > 1_000_000) return this.#say([{ message: `${file.name} has ${file.size} bytes, expected at most 1000000` }]);
    this.name = file.name.replace(/\.toml$/i, "");
    this.text.value = await file.text();
    await this.#open();
  }

  async #open() {
    const text = this.text.value;
    if (Store.carried(text)) {
      this.dialog.close();
      await this.app.follow(text);
      return;
    }
    this.#say([{ message: "reading …" }]);
    const wrong = await this.app.open(text, () => this.dialog.open, this.name).catch((error) => [{ message: error.message }]);
    if (!this.dialog.open) return; // cancelled meanwhile
    if (wrong.length) return this.#say(wrong);
    this.dialog.close();
    note("Opened.");
  }

  #say(wrong) {
    this.list.replaceChildren(...wrong.map((each) => make("li", {}, `${each.line ? `line ${each.line}: ` : ""}${each.field ? `${each.field}: ` : ""}${each.message}`)));
  }
}
