import type { Said, Style } from "./said.ts";

/** Colours of what is no mark, by the ground they stand on. */
const GROUNDS = {
  light: { paper: "#ffffff", rim: "#ffffff", text: "#1b1f24", muted: "#57606a", ring: "#111111", body: "#e8eaed" },
  dark: { paper: "#14181d", rim: "#14181d", text: "#e6e9ed", muted: "#a0a8b2", ring: "#ffffff", body: "#2b3138" },
};

export type Ground = (typeof GROUNDS)["light"];

/** The table of styles, in the tones of the system's setting. */
export class Styles {
  private readonly byName: Map<string, Style>;
  private readonly setting = matchMedia("(prefers-color-scheme: dark)");

  constructor(said: Said) {
    this.byName = new Map(said.styles.map((style) => [style.name, style]));
  }

  /** Calls back when the system's setting changes. */
  onChange(changed: () => void): void {
    this.setting.addEventListener("change", changed);
  }

  get isDark(): boolean {
    return this.setting.matches;
  }

  get ground(): Ground {
    return this.isDark ? GROUNDS.dark : GROUNDS.light;
  }

  of(name: string): Style {
    return (
      this.byName.get(name) ?? { name, words: name, shape: "disc", light: GROUNDS.light.muted, dark: GROUNDS.dark.muted }
    );
  }

  color(name: string): string {
    const style = this.of(name);
    return this.isDark ? style.dark : style.light;
  }

  /** How far in front marks of this name are drawn. */
  rank(name: string): number {
    return [...this.byName.keys()].indexOf(name);
  }
}
