// A file for a job: one that is on the server already, or one to upload, by choosing or dropping it.

import { upload, type FileReference, type NamedFile, type Upload } from "../api";
import { button, element } from "../elements";
import { failureBox } from "../problem";
import { bytes, percent } from "../text";

export interface ServerFile {
  readonly value: string;
  readonly text: string;
  readonly reference: FileReference;
}

export const namedFiles = (files: readonly NamedFile[]): ServerFile[] =>
  files.map(({ name, bytes: size }) => ({ value: `name:${name}`, text: `${name}, ${bytes(size)}`, reference: { name } }));
export const uploadedFiles = (files: readonly Upload[]): ServerFile[] =>
  files.map(({ id, name, bytes: size, created }) => ({
    value: `upload:${id}`,
    text: `${name}, ${bytes(size)}, uploaded ${new Date(created).toLocaleString()}`,
    reference: { upload: id },
  }));

export class FileChoice {
  private readonly select: HTMLSelectElement;
  private readonly status = element("div", { "aria-live": "polite" });
  private readonly drop: HTMLElement;
  private readonly input: HTMLInputElement;
  private running: AbortController | null = null;
  readonly element: HTMLElement;

  constructor(
    name: string,
    hint: string,
    private readonly files: ServerFile[],
    private readonly signal: AbortSignal,
  ) {
    this.select = element("select", { id: name }, ...this.options());
    this.input = element("input", { type: "file", id: `${name}-file` });
    this.input.addEventListener("change", () => this.input.files![0] !== undefined && void this.send(this.input.files![0]));
    this.drop = element(
      "div",
      { class: "drop" },
      element("label", { for: `${name}-file` }, "Drop a file here, or choose one"),
      " ",
      this.input,
      element("p", { class: "soft" }, hint),
    );
    this.listen();
    this.element = element(
      "div",
      { "data-pointer": `/${name}`, class: "file" },
      element("div", { class: "field" }, element("label", { for: name }, "On the server"), this.select),
      this.drop,
      this.status,
    );
  }

  private options(): HTMLOptionElement[] {
    return [
      element("option", { value: "" }, this.files.length === 0 ? "nothing yet" : "choose\u2026"),
      ...this.files.map(({ value, text }) => element("option", { value }, text)),
    ];
  }

  private listen(): void {
    const over = (is: boolean) => (event: DragEvent) => {
      event.preventDefault();
      this.drop.classList.toggle("over", is);
    };
    this.drop.addEventListener("dragover", over(true));
    this.drop.addEventListener("dragleave", over(false));
    this.drop.addEventListener("drop", (event) => {
      over(false)(event);
      const file = event.dataTransfer?.files[0];
      if (file !== undefined) void this.send(file);
    });
  }

  private async send(file: File): Promise<void> {
    this.running?.abort();
    const running = (this.running = new AbortController());
    this.signal.addEventListener("abort", () => running.abort());
    const bar = element("progress", { max: 1, value: 0, "aria-label": `Upload of ${file.name}` }),
      text = element("span", {}, "");
    this.status.replaceChildren(
      element(
        "p",
        {},
        `Uploading ${file.name}, ${bytes(file.size)}: `,
        text,
        " ",
        button("Give up", () => running.abort()),
      ),
      bar,
    );
    try {
      const done = await upload(
        file,
        (share) => {
          bar.value = share;
          text.textContent = percent(Math.round(100 * share) / 100);
        },
        running.signal,
      );
      this.take(done);
    } catch (error) {
      this.status.replaceChildren(running.signal.aborted ? element("p", {}, "Given up.") : failureBox(error));
    }
    this.running = null;
  }

  private take(done: Upload): void {
    this.files.unshift({
      value: `upload:${done.id}`,
      text: `${done.name}, ${bytes(done.bytes)}, just uploaded`,
      reference: { upload: done.id },
    });
    this.select.replaceChildren(...this.options());
    this.select.value = `upload:${done.id}`;
    this.status.replaceChildren(element("p", {}, `${done.name} is uploaded and chosen.`));
  }

  get busy(): boolean {
    return this.running !== null;
  }

  get reference(): FileReference | undefined {
    return this.files.find((file) => file.value === this.select.value)?.reference;
  }
}
