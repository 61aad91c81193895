import { glyph, make } from "./dom.ts";
import type { Drive, Method } from "./drive.ts";
import { upper } from "./drive.ts";
import type { ShapeName } from "./said.ts";
import type { State } from "./state.ts";
import type { Styles } from "./styles.ts";

/** What SVG paths the shapes are. */
const PATHS: Record<ShapeName, string> = {
  disc: "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0",
  dot: "M-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0",
  speck: "M-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0",
  plus: "M-5 0h10M0-5v10",
  cross: "M-3.5-3.5l7 7M-3.5 3.5l7-7",
  square: "M-3.5-3.5h7v7h-7z",
  triangle: "M0-4.5l4.3 7.5h-8.6z",
  nabla: "M0 4.5l4.3-7.5h-8.6z",
  diamond: "M0-5l5 5-5 5-5-5z",
  line: "M-6 3q6-8 12 0",
};

interface Layer {
  name: string;
  words: string;
  style: string;
  path?: string;
}

/** One button for each layer and each kind of echo. */
export class Legend {
  private readonly buttons = new Map<string, { button: HTMLButtonElement; number: HTMLElement }>();

  constructor(
    private readonly place: HTMLElement,
    private readonly drive: Drive,
    private readonly styles: Styles,
    private readonly changed: () => void,
  ) {}

  /** The layers that there are for these panels, anew. */
  build(state: State, methods: Method[]): void {
    this.buttons.clear();
    this.place.replaceChildren(
      ...this.layers(methods).map((layer) => {
        const number = make("span", "", { class: "number" });
        const word = make("span", layer.words, { class: "word" });
        const button = make("button", "", { type: "button", "data-layer": layer.name }, this.glyph(layer), word, number);
        button.addEventListener("click", () => {
          if (!state.hidden.delete(layer.name)) state.hidden.add(layer.name);
          this.changed();
        });
        this.buttons.set(layer.name, { button, number });
        return button;
      }),
    );
  }

  private layers(methods: Method[]): Layer[] {
    const { said } = this.drive;
    const all: Layer[] = [];
    const fused = methods.some((method) => method.name === "atm");
    if (said.world) all.push({ name: "walls", words: "walls", style: "solid", path: "M-7 0h14" });
    if (said.world?.openings.length) {
      all.push({ name: "opening", words: "opening", style: "open", path: "M-6-5v10M6-5v10M-6 0h12" });
    }
    all.push(
      { name: "path", words: "path", style: "path", path: "M-7 4q4-9 7-4t7-4" },
      { name: "robot", words: "robot", style: "robot", path: "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0M3 0l-5-2v4z" },
      { name: "cones", words: "cones now", style: "arcs", path: "M-6 0l12-5q2 5 0 10z" },
      { name: "arcs", words: "arcs now", style: "arcs" },
    );
    if (fused && this.drive.on.length > 0) {
      all.push({ name: "crossings", words: "crossings now", style: "crossings" });
      all.push({ name: "all crossings", words: "all crossings", style: "crossings" });
    }
    if (this.drive.truthX.length > 0) all.push({ name: "truth", words: "true echo points", style: "truth" });
    const kinds = new Set(methods.flatMap((method) => method.kinds.filter((kind) => kind.x.length).map((kind) => kind.name)));
    for (const name of [...kinds].sort((a, b) => this.styles.rank(a) - this.styles.rank(b))) {
      all.push({ name, words: this.styles.of(name).words, style: name });
    }
    return all;
  }

  private glyph({ style, path }: Layer): SVGSVGElement {
    const { shape } = this.styles.of(style);
    const color = this.styles.color(style);
    const isLine = path !== undefined || shape === "line" || shape === "plus" || shape === "cross";
    const ink: Record<string, string> = isLine ? { fill: "none", stroke: color, "stroke-width": "1.8" } : { fill: color };
    return glyph([{ d: path ?? PATHS[shape], ...ink }]);
  }

  /** What is shown and how many of each kind there are at a pose. */
  update(state: State, methods: Method[], pose: number): void {
    for (const [name, { button, number }] of this.buttons) {
      const pressed = String(state.shows(name));
      if (button.getAttribute("aria-pressed") !== pressed) button.setAttribute("aria-pressed", pressed);
      const kinds = methods.flatMap((method) => method.kinds.filter((kind) => kind.name === name));
      const counts = [...new Set(kinds)].map((kind) => upper(kind.at, pose));
      const words = counts.map((count) => count.toLocaleString("en")).join(" + ");
      if (number.textContent !== words) number.textContent = words;
    }
  }
}
