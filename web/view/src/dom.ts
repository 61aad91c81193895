/** The element of this id. */
export function byId<T extends HTMLElement>(id: string, type: new () => T): T {
  const element = document.getElementById(id);
  if (!(element instanceof type)) throw new Error(`the page has no ${id}`);
  return element;
}

/** A new element with words in it; they are text, whatever they look like. */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  words = "",
  attributes: Record<string, string> = {},
  ...children: Node[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  if (words) element.textContent = words;
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

const SVG = "http://www.w3.org/2000/svg";

/** A small picture of 16 pixels. */
export function glyph(attributes: Record<string, string>[]): SVGSVGElement {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "-8 -8 16 16");
  svg.setAttribute("aria-hidden", "true");
  for (const one of attributes) {
    const path = document.createElementNS(SVG, "path");
    for (const [name, value] of Object.entries(one)) path.setAttribute(name, value);
    svg.append(path);
  }
  return svg;
}
