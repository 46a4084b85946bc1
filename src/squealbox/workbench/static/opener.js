// The dialog that opens a design file, a text or a link; what is wrong with it is said with line and key.

import { make, note } from "./elements.js";
import { Store } from "./store.js";

const OWN = "sliding_speed = \"1 m/s\"\nnormal_force = \"500 N\"\nfriction = { law = \"coulomb\", static = 0.4 }\n\n[[contacts]]   # one number for each degree of freedom\nn = [0, 0]     # normal force for each metre [N/m]\nd = [0, 0]     # where friction acts";

export class Opener {
  constructor(app) {
    this.app = app;
    const get = (id) => document.getElementById(id);
    this.dialog = get("opener");
    this.text = get("opener-text");
    this.list = get("opener-problems");
    get("opener-go").addEventListener("click", () => this.#open());
    get("opener-cancel").addEventListener("click", () => this.dialog.close());
    get("opener-file").addEventListener("change", (event) => this.#read([...event.target.files]));
    document.addEventListener("dragover", (event) => event.preventDefault());
    document.addEventListener("drop", (event) => {
      event.preventDefault();
      const files = [...event.dataTransfer.files];
      if (files.length === 1 && /\.(wav|flac|ogg|csv|npy|uff|unv)$/i.test(files[0].name)) return this.app.panels.get("recording")?.take(files[0]);
      this.show();
      this.#read(files);
    });
  }

  show() {
    [this.name, this.files] = [null, []];
    this.list.replaceChildren();
    if (!this.dialog.open) this.dialog.showModal();
  }

  /** A design file, with the files it names; of matrices alone the text of a file that names them. */
  async #read(files) {
    const design = files.find(({ name }) => /\.(toml|txt)$/i.test(name));
    this.files = files.filter((file) => file !== design);
    if (!design) {
      const matrices = this.files.filter(({ name }) => /^[MCK]\b|^[MCK]_/i.test(name)).map(({ name }) => `${name[0].toUpperCase()} = "${name}"`);
      this.text.value = ['brake = "own"', ...matrices, OWN].join("\n");
      return this.#say([{ message: matrices.length ? "say where it rubs, then press Open" : "expected a design file, or matrices named M, C and K" }]);
    }
    if (design.size > 1_000_000) return this.#say([{ message: `${design.name} has ${design.size} bytes, expected at most 1000000` }]);
    this.name = design.name.replace(/\.toml$/i, "");
    this.text.value = await design.text();
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
    const wrong = await this.app.open(text, () => this.dialog.open, this.name, this.files).catch((error) => [{ message: error.message }]);
    if (!this.dialog.open) return; // cancelled meanwhile
    if (wrong.length) return this.#say(wrong);
    this.dialog.close();
    note("Opened.");
  }

  #say(wrong) {
    this.list.replaceChildren(...wrong.map((each) => make("li", {}, `${each.line ? `line ${each.line}: ` : ""}${each.field ? `${each.field}: ` : ""}${each.message}`)));
  }
}
