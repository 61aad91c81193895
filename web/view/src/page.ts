import type { Box } from "./camera.ts";
import { byId, make } from "./dom.ts";
import type { Drive, Method } from "./drive.ts";
import { upper } from "./drive.ts";
import { listen } from "./gestures.ts";
import { Legend } from "./legend.ts";
import { gap, lines, shown } from "./measure.ts";
import { Panel, extent } from "./panel.ts";
import { details, neighbour, pick } from "./pick.ts";
import { picture, save } from "./picture.ts";
import { State, length } from "./state.ts";
import { Styles } from "./styles.ts";
import { distance, seconds, settings, summary } from "./summary.ts";

const SPEEDS = [0.25, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
/** About so many seconds a replay takes when nobody has chosen its speed. */
const WATCHED = 20;
/** So long, in milliseconds, nothing changes before what is shown is put into words. */
const CALM = 120;
/** How near to a mark the pointer has to be, in pixels; a finger is wider. */
const REACH = 9;
const FINGER = 22;
const PLAY = "M4 2l10 6-10 6z";
const PAUSE = "M3 2h4v12H3zM9 2h4v12H9z";

interface Shown {
  panel: Panel;
  stage: HTMLElement;
  select: HTMLSelectElement;
  words: HTMLElement;
  scale: HTMLElement;
}

/** The whole page: what is on it, and what happens on it. */
export class Page {
  private readonly state = new State();
  private readonly styles: Styles;
  private readonly legend: Legend;
  private readonly shown: Shown[] = [];
  private readonly slider = byId("time", HTMLInputElement);
  private readonly card = byId("card", HTMLElement);
  private readonly everything: Box;
  private two = true;
  private due = false;
  private held = false;
  private last = 0;
  private describing = 0;
  /** The camera as everything was last fitted into the panels. */
  private fitted = "";

  constructor(private readonly drive: Drive) {
    this.styles = new Styles(drive.said);
    this.everything = extent(drive) ?? [-1, -1, 1, 1];
    this.state.units = drive.said.units;
    const methods = drive.methods;
    this.state.methods = [methods[0], methods[1] ?? methods[0]];
    this.two = methods.length > 1;
    // No better than the cone: what a robot would drive by is seen without it.
    for (const layer of ["center", "all crossings"]) this.state.hidden.add(layer);
    this.legend = new Legend(byId("layers", HTMLElement), drive, this.styles, () => {
      this.redraw();
    });
  }

  start(): void {
    this.head();
    for (let i = 0; i < 2; i++) this.addPanel(i);
    this.buttons();
    this.transport();
    document.addEventListener("keydown", (event) => {
      if (this.key(event)) event.preventDefault();
    });
    this.styles.onChange(() => {
      this.legend.build(this.state, this.visible());
      this.redraw();
    });
    new ResizeObserver(() => {
      this.resize();
    }).observe(byId("panels", HTMLElement));
    this.split(this.two);
    this.legend.build(this.state, this.visible());
    this.seek(this.drive.duration);
  }

  private head(): void {
    const { drive } = this;
    const { said } = drive;
    byId("name", HTMLHeadingElement).textContent = said.name.split(/[/\\]/).pop() ?? said.name;
    const readings = said.thinned.readings.toLocaleString("en");
    const duration = seconds(drive.elapsed[drive.elapsed.length - 1]);
    byId("counts", HTMLParagraphElement).textContent =
      `${readings} readings · ${duration} · ${length(distance(drive), said.units)} driven`;
    byId("command", HTMLElement).textContent = said.command;
    summary(byId("summary", HTMLTableElement), drive, this.styles);
    settings(byId("settings", HTMLTableElement), drive, this.state);
    if (said.thinned.stride > 1) {
      const notice = byId("notice", HTMLParagraphElement);
      notice.hidden = false;
      notice.textContent = `Thinned: one reading in ${said.thinned.stride} of each sensor is shown, of ${readings}. The summary counts all of them.`;
    }
  }

  private addPanel(index: number): void {
    const canvas = make("canvas", "", { "aria-hidden": "true" });
    const scale = make("div", "", { class: "scale", "aria-hidden": "true" }, make("span"));
    const stage = make("div", "", { class: "stage", role: "img" }, canvas, scale);
    const label = index === 0 ? "Method of the first panel" : "Method of the second panel";
    const select = make("select", "", { "aria-label": label });
    this.drive.methods.forEach((method, i) => { select.append(make("option", method.words, { value: String(i) })); });
    const words = make("span");
    byId("panels", HTMLElement).append(make("figure", "", {}, make("figcaption", "", {}, select, words), stage));
    const panel = new Panel(canvas, this.drive, this.styles);
    this.shown.push({ panel, stage, select, words, scale });
    select.value = String(this.drive.methods.indexOf(this.state.methods[index]));
    select.addEventListener("change", () => {
      this.state.methods[index] = this.drive.methods[Number(select.value)];
      this.state.chosen = null;
      this.legend.build(this.state, this.visible());
      this.redraw();
    });
    listen(stage, panel, this.state, {
      over: (x, y, tapped) => {
        this.over(index, x, y, tapped);
      },
      left: () => {
        if (!this.held) this.choose(index, null);
      },
      changed: () => {
        this.redraw();
      },
    });
  }

  /** The methods of the panels that are there. */
  private visible(): Method[] {
    return this.two ? this.state.methods : this.state.methods.slice(0, 1);
  }

  private buttons(): void {
    const on = (id: string, act: () => void) => {
      byId(id, HTMLButtonElement).addEventListener("click", act);
    };
    on("fit", () => {
      this.fit();
    });
    on("measure", () => {
      this.measure(!this.state.measuring);
    });
    on("units", () => {
      this.units();
    });
    on("split", () => {
      this.split(!this.two);
    });
    on("save", () => {
      this.save();
    });
    on("help", () => {
      byId("keys", HTMLDialogElement).showModal();
    });
    on("copy", () => {
      this.copy();
    });
    on("play", () => {
      this.play(!this.state.playing);
    });
    byId("units", HTMLButtonElement).textContent = this.state.units;
  }

  private transport(): void {
    const { slider, drive, state } = this;
    slider.max = String(Math.max(drive.duration, 1e-9));
    slider.addEventListener("input", () => {
      this.play(false);
      this.seek(Number(slider.value));
    });
    const speed = byId("speed", HTMLSelectElement);
    for (const one of SPEEDS) speed.append(make("option", `${one}×`, { value: String(one) }));
    state.speed = SPEEDS.find((one) => drive.duration / one <= WATCHED) ?? SPEEDS[SPEEDS.length - 1];
    speed.value = String(state.speed);
    speed.addEventListener("change", () => {
      state.speed = Number(speed.value);
    });
  }

  /** What keys zoom about: the chosen echo, else the middle of the panel. */
  private middle(): [number, number] {
    const { chosen, camera } = this.state;
    const { width, height } = this.shown[0].panel;
    if (!chosen) return [width / 2, height / 2];
    const { method, echo } = chosen;
    return [width / 2 + (method.x[echo] - camera.x) * camera.scale, height / 2 - (method.y[echo] - camera.y) * camera.scale];
  }

  /** Whether the key meant something here. */
  private key(event: KeyboardEvent): boolean {
    if (event.ctrlKey || event.altKey || event.metaKey || byId("keys", HTMLDialogElement).open) return false;
    const target = event.target;
    const { width, height } = this.shown[0].panel;
    if (target instanceof HTMLSelectElement) return false;
    if (target instanceof HTMLButtonElement && (event.key === " " || event.key === "Enter")) return false;
    const zoom = (factor: number) => {
      this.state.camera.zoom(factor, ...this.middle(), width, height);
      this.redraw();
    };
    const acts: Record<string, () => void> = {
      " ": () => { this.play(!this.state.playing); },
      ArrowLeft: () => { this.step(event.shiftKey ? -10 : -1); },
      ArrowRight: () => { this.step(event.shiftKey ? 10 : 1); },
      Home: () => { this.play(false); this.seek(0); },
      End: () => { this.play(false); this.seek(this.drive.duration); },
      "+": () => { zoom(1.25); },
      "=": () => { zoom(1.25); },
      "-": () => { zoom(0.8); },
      f: () => { this.fit(); },
      m: () => { this.measure(!this.state.measuring); },
      "2": () => { this.split(!this.two); },
      u: () => { this.units(); },
      s: () => { this.save(); },
      "?": () => { byId("keys", HTMLDialogElement).showModal(); },
      "[": () => { this.walk(-1); },
      "]": () => { this.walk(1); },
      Escape: () => { this.letGo(); },
    };
    const act = acts[event.key] as (() => void) | undefined;
    act?.();
    return act !== undefined;
  }

  private play(playing: boolean): void {
    const { state } = this;
    if (playing && state.time >= this.drive.duration) this.seek(0);
    state.playing = playing;
    const button = byId("play", HTMLButtonElement);
    button.setAttribute("aria-label", playing ? "Pause" : "Play");
    document.getElementById("sign")?.setAttribute("d", playing ? PAUSE : PLAY);
    if (playing) {
      this.last = performance.now();
      this.redraw();
    } else this.describe();
  }

  private seek(time: number): void {
    this.state.time = Math.min(Math.max(time, 0), this.drive.duration);
    this.redraw();
  }

  /** Some poses on. */
  private step(poses: number): void {
    this.play(false);
    const { clock } = this.drive;
    const pose = this.drive.poseAt(this.state.time) + poses;
    this.seek(clock[Math.min(Math.max(pose, 0), clock.length - 1)]);
    this.describe();
  }

  private measure(measuring: boolean): void {
    this.state.measuring = measuring;
    if (!measuring) this.state.line = null;
    byId("measure", HTMLButtonElement).setAttribute("aria-pressed", String(measuring));
    for (const { stage } of this.shown) stage.classList.toggle("measuring", measuring);
    this.redraw();
  }

  private units(): void {
    this.state.units = this.state.units === "m" ? "in" : "m";
    byId("units", HTMLButtonElement).textContent = this.state.units;
    settings(byId("settings", HTMLTableElement), this.drive, this.state);
    this.redraw();
  }

  private split(two: boolean): void {
    this.two = two;
    byId("panels", HTMLElement).classList.toggle("one", !two);
    byId("split", HTMLButtonElement).setAttribute("aria-pressed", String(two));
    this.legend.build(this.state, this.visible());
    this.resize();
  }

  private save(): void {
    this.render();
    const panels = this.panels().map(({ panel }) => panel);
    const stem = (this.drive.said.name.split(/[/\\]/).pop() ?? "atm").replace(/\.[^.]*$/, "") || "atm";
    const stacked = panels.length > 1 && this.shown[1].stage.offsetTop > this.shown[0].stage.offsetTop;
    save(picture(this.drive, panels, stacked, this.state, this.styles), `${stem}.png`);
  }

  private copy(): void {
    const said = byId("said", HTMLParagraphElement);
    const text = byId("command", HTMLElement);
    // Pages that are files may not write to the clipboard: the text is chosen then, ready to be copied.
    navigator.clipboard.writeText(this.drive.said.command).then(
      () => {
        said.textContent = "The command is in the clipboard.";
      },
      () => {
        getSelection()?.selectAllChildren(text);
      },
    );
  }

  private panels(): Shown[] {
    return this.two ? this.shown : this.shown.slice(0, 1);
  }

  private resize(): void {
    this.arrange();
    for (const { panel } of this.panels()) panel.resize();
    const { x, y, scale } = this.state.camera;
    // Somebody has moved it: it stays.
    if (this.fitted === `${x} ${y} ${scale}` || this.fitted === "") this.fit();
    this.render();
  }

  /** Above one another where more can be seen so: a drive along a corridor is wide. */
  private arrange(): void {
    const [left, bottom, right, top] = this.everything;
    const [width, height] = [Math.max(right - left, 0.5), Math.max(top - bottom, 0.5)];
    const panels = byId("panels", HTMLElement);
    const [wide, high] = [panels.clientWidth, Math.max(220, innerHeight - 232)];
    const beside = Math.min(wide / 2 / width, high / height);
    const above = Math.min(wide / width, (high / 2 - 30) / height);
    panels.classList.toggle("stacked", this.two && above > 1.2 * beside);
  }

  private fit(): void {
    const { panel } = this.shown[0];
    const { camera } = this.state;
    camera.fit(this.everything, panel.width, panel.height);
    this.fitted = panel.width > 0 ? `${camera.x} ${camera.y} ${camera.scale}` : "";
    for (const { panel } of this.shown) panel.fitted = camera.scale;
    this.redraw();
  }

  private redraw(): void {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame((now) => {
      this.due = false;
      this.advance(now);
      this.render();
    });
  }

  /** The clock goes on while it plays. */
  private advance(now: number): void {
    const { state, drive } = this;
    if (!state.playing) return;
    state.time += (Math.max(0, now - this.last) / 1000) * state.speed;
    this.last = now;
    if (state.time >= drive.duration) {
      state.time = drive.duration;
      this.play(false);
    } else this.redraw();
  }

  private render(): void {
    const { state, drive } = this;
    const pose = drive.poseAt(state.time);
    this.panels().forEach((shown, i) => {
      shown.panel.draw(state.methods[i], state);
      shown.words.textContent = this.words(state.methods[i], pose);
    });
    this.scales();
    this.legend.update(this.state, this.visible(), pose);
    this.slider.value = String(state.time);
    const [now, all] = [seconds(drive.elapsed[pose]), seconds(drive.elapsed[drive.elapsed.length - 1])];
    byId("clock", HTMLOutputElement).textContent = `${now} / ${all}`;
    this.slider.setAttribute("aria-valuetext", `${now} of ${all}`);
    if (!state.playing) this.describe();
  }

  /** Puts what a panel shows into words, once nothing has changed for a moment. */
  private describe(): void {
    clearTimeout(this.describing);
    this.describing = setTimeout(() => {
      this.described();
    }, CALM);
  }

  /** What a panel shows, in words: counts by kind, and free widths. */
  private words(method: Method, pose: number): string {
    const kinds = method.kinds.filter((kind) => this.state.shows(kind.name) && kind.x.length > 0);
    const counts = kinds.map((kind) => {
      const name = kind.name === "centerline" ? "centres" : kind.name;
      return `${upper(kind.at, pose).toLocaleString("en")} ${name}`;
    });
    return counts.length > 0 ? counts.join(", ") : "all kinds are switched off";
  }

  /** The same for those who do not see the panels. */
  private described(): void {
    const { state, drive } = this;
    const pose = drive.poseAt(state.time);
    this.panels().forEach(({ stage }, i) => {
      const method = state.methods[i];
      const free = lines(drive, state).map((line) => {
        const found = gap(line, shown(method, pose, state), drive.said.depth, drive.said.jamb);
        const open = found.marked[0] && found.marked[1] ? found.free[1] - found.free[0] : 0;
        return `; ${length(open, state.units)} of an opening of ${length(found.width, state.units)} are free`;
      });
      stage.setAttribute("aria-label", `${method.words}: ${this.words(method, pose)}${free.join("")}`);
    });
  }

  /** How long a round length is in the panels. */
  private scales(): void {
    const { units, camera } = this.state;
    const unit = units === "in" ? 0.0254 : 1;
    const room = Math.min(130, this.shown[0].panel.width / 4) / (camera.scale * unit);
    const power = 10 ** Math.floor(Math.log10(room));
    const nice = [5, 2, 1].map((step) => step * power).find((step) => step <= room) ?? power;
    const words = units === "in" ? `${Number(nice.toPrecision(3))} in` : length(nice, "m", 0);
    const width = `${(nice * unit * camera.scale).toFixed(1)}px`;
    for (const { scale } of this.shown) {
      if (scale.style.width !== width) scale.style.width = width;
      const number = scale.firstElementChild;
      if (number && number.textContent !== words) number.textContent = words;
    }
  }

  private over(index: number, x: number, y: number, tapped: boolean): void {
    if (this.held && !tapped) return;
    const { panel } = this.shown[index];
    const pose = this.drive.poseAt(this.state.time);
    const reach = tapped && matchMedia("(pointer: coarse)").matches ? FINGER : REACH;
    const echo = pick(this.state.methods[index], panel.view(this.state), pose, this.state, x, y, reach);
    this.held = tapped && echo !== null;
    this.choose(index, echo);
  }

  private choose(index: number, echo: number | null): void {
    const { state } = this;
    const method = state.methods[index];
    if (echo === null ? !state.chosen : state.chosen?.method === method && state.chosen.echo === echo) return;
    state.chosen = echo === null ? null : { method, echo };
    this.showCard(index);
    this.redraw();
  }

  private letGo(): void {
    this.held = false;
    this.state.line = null;
    this.choose(0, null);
    this.measure(false);
  }

  /** The echo before or after the chosen one, in the panel that it is in: in the second, where the sharp ones are. */
  private walk(step: 1 | -1): void {
    const { state } = this;
    const held = state.chosen ? state.methods.indexOf(state.chosen.method) : -1;
    const index = held >= 0 ? held : this.two ? 1 : 0;
    const pose = this.drive.poseAt(state.time);
    const echo = neighbour(state.methods[index], pose, state, state.chosen?.echo ?? null, step);
    if (echo === null) return;
    this.held = true;
    // Into the panel, where it is outside.
    const [x, y] = [state.methods[index].x[echo], state.methods[index].y[echo]];
    const { camera } = state;
    const { width, height } = this.shown[index].panel;
    const [off, up] = [Math.abs(x - camera.x), Math.abs(y - camera.y)];
    if (off * camera.scale > 0.47 * width || up * camera.scale > 0.47 * height) [camera.x, camera.y] = [x, y];
    this.choose(index, echo);
  }

  private showCard(index: number): void {
    const { card, state } = this;
    card.hidden = !state.chosen;
    if (!state.chosen) return;
    const list = make("dl");
    for (const [name, value] of details(this.drive, state.chosen, state.units)) list.append(make("dt", name), make("dd", value));
    card.replaceChildren(list);
    const { panel, stage } = this.shown[index];
    const box = stage.getBoundingClientRect();
    const view = panel.view(state);
    const { method, echo } = state.chosen;
    const [x, y] = [box.left + view.px(method.x[echo]) / view.ratio, box.top + view.py(method.y[echo]) / view.ratio];
    card.dataset["at"] = `${x.toFixed(1)} ${y.toFixed(1)}`;
    const sensor = box.top + view.py(this.drive.sy[method.reading[echo]]) / view.ratio;
    const { width, height } = card.getBoundingClientRect();
    // On the side of the echo that the beam does not come from.
    const fit = (at: number, size: number, room: number) => `${Math.max(8, Math.min(at, room - size - 8))}px`;
    card.style.left = fit(x + 22 + width < innerWidth ? x + 22 : x - 22 - width, width, innerWidth);
    card.style.top = fit(sensor > y ? y - height + 6 : y - 6, height, innerHeight);
  }
}
