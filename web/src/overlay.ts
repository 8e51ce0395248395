/** What the server did for the picture on screen, and what it cost. */

import { el } from './dom';
import { rateText } from './figures';
import { bytes, count, millis, significant, words } from './format';
import type { FrameHeader } from './header';
import type { LatencySummary } from './latency';
import type { Plan, Stats } from './protocol.gen';
import { Sparkline } from './sparkline';
import './overlay.css';

export interface OverlayState {
  header: FrameHeader | null;
  stats: Stats | null;
  plan: Plan | null;
  latency: LatencySummary | null;
  latencyHistory: readonly number[];
  framesPerSecond: number;
  bytesPerSecond: number;
}

const LATENCY_PARTS = ['render', 'encode', 'transit', 'decode'] as const;
const PICTURE_ROWS = [
  'Picture',
  'Size',
  'Samples',
  'Error',
  'Transmittance',
  'Luminance',
  'Non-finite',
] as const;

type PictureRow = (typeof PICTURE_ROWS)[number];

export class Overlay {
  private readonly rate = el('strong', {}, '–');
  private readonly latency = el('strong', {}, '–');
  private readonly bandwidth = el('strong', {}, '–');
  private readonly body = el('div', {
    id: 'overlay-body',
    // Scrollable, and without anything in it that takes the focus.
    tabindex: '0',
    role: 'group',
    'aria-label': 'Figures of the last picture',
  });
  private readonly spark = new Sparkline(120);
  private readonly parts = new Map<string, { bar: HTMLElement; text: HTMLElement }>();
  private readonly spread = el('span', { class: 'aside' });
  private readonly rows = new Map<PictureRow, HTMLElement>();
  private readonly passes = el('ul', { class: 'passes' });
  private readonly planned = el('ul', { class: 'plan' });
  private readonly skipped = el('ul', { class: 'plan skipped' });
  private readonly skippedTitle = el('h3', {}, 'Skipped');
  private shownPlan: Plan | null = null;

  constructor(private readonly root: HTMLElement) {
    const figure = (value: HTMLElement, unit: string) =>
      el('span', { class: 'figure' }, value, el('small', {}, unit));
    const headline = el('div', { class: 'headline' });
    headline.append(
      figure(this.rate, 'rate'),
      figure(this.latency, 'latency'),
      figure(this.bandwidth, 'per second'),
    );
    root.append(headline, this.body);
    this.body.append(
      this.section('Input to paint', this.latencySection(), this.spread),
      this.section('Picture', this.pictureSection()),
      this.section('Passes', this.passes),
      this.section('Plan', el('div', {}, this.planned, this.skippedTitle, this.skipped)),
    );
  }

  setOpen(open: boolean): void {
    this.root.hidden = !open;
  }

  show(state: OverlayState): void {
    if (this.root.hidden) return;
    const { header, stats, latency } = state;
    this.rate.textContent = header === null ? '–' : rateText(state.framesPerSecond, header);
    this.latency.textContent = latency === null ? '–' : millis(latency.total);
    this.bandwidth.textContent = bytes(state.bytesPerSecond);
    this.showLatency(latency, state.latencyHistory);
    if (header !== null) this.showPicture(header, stats);
    if (stats !== null) this.showPasses(stats);
    if (state.plan !== null && state.plan !== this.shownPlan) this.showPlan(state.plan);
  }

  private section(title: string, content: Node, aside?: Node): HTMLElement {
    const heading = el('h2', {}, title);
    if (aside !== undefined) heading.append(aside);
    return el('div', { class: 'block' }, heading, content);
  }

  private latencySection(): HTMLElement {
    const stack = el('div', { class: 'stack', 'aria-hidden': 'true' });
    const legend = el('dl', { class: 'legend' });
    for (const part of LATENCY_PARTS) {
      const bar = el('i', { class: `part-${part}` });
      const text = el('dd', {}, '–');
      stack.append(bar);
      legend.append(el('div', {}, el('dt', { class: `part-${part}` }, part), text));
      this.parts.set(part, { bar, text });
    }
    const box = el('div', {});
    box.append(this.spark.element, stack, legend);
    return box;
  }

  private pictureSection(): HTMLElement {
    const list = el('dl', { class: 'facts' });
    for (const name of PICTURE_ROWS) {
      const value = el('dd', {}, '–');
      this.rows.set(name, value);
      list.append(el('dt', {}, name), value);
    }
    return list;
  }

  private showLatency(latency: LatencySummary | null, history: readonly number[]): void {
    this.spark.show(history);
    if (latency === null) {
      this.spread.textContent = 'move to measure';
      return;
    }
    this.spread.textContent = `median ${millis(latency.total)} · p95 ${millis(latency.p95)}`;
    const sum = LATENCY_PARTS.reduce((total, part) => total + latency[part], 0);
    for (const part of LATENCY_PARTS) {
      const { bar, text } = this.parts.get(part) ?? {};
      bar?.style.setProperty('flex-grow', String(sum > 0 ? latency[part] / sum : 0));
      if (text !== undefined) text.textContent = millis(latency[part]);
    }
  }

  private showPicture(header: FrameHeader, stats: Stats | null): void {
    this.row('Picture', `${header.width} × ${header.height} ${header.codec}`);
    const perPixel = (header.payloadBytes * 8) / (header.width * header.height);
    this.row('Size', `${bytes(header.payloadBytes)} · ${perPixel.toFixed(2)} bit/px`);
    this.row('Samples', `${count(header.samples)}${header.converged ? ' · converged' : ''}`);
    const error = header.estimatedError;
    this.row('Error', error === null ? 'not estimated' : `${significant(error * 100, 2)} %`);
    if (stats === null) return;
    this.row('Transmittance', significant(stats.mean_transmittance));
    this.row('Luminance', significant(stats.mean_luminance));
    const odd = [`${count(stats.non_finite)}`];
    if (stats.negative > 0) odd.push(`${count(stats.negative)} negative`);
    if (stats.clamped > 0) odd.push(`${count(stats.clamped)} clamped`);
    this.row('Non-finite', odd.join(' · '));
    this.rows.get('Non-finite')?.classList.toggle('bad', stats.non_finite + stats.negative > 0);
  }

  private row(name: PictureRow, text: string): void {
    const cell = this.rows.get(name);
    if (cell !== undefined) cell.textContent = text;
  }

  private showPasses(stats: Stats): void {
    const times = stats.pass_times;
    while (this.passes.children.length > times.length) this.passes.lastChild?.remove();
    while (this.passes.children.length < times.length) {
      this.passes.append(el('li', {}, el('span'), el('b'), el('i')));
    }
    const longest = Math.max(1, ...times.map(({ micros }) => micros));
    for (const [index, { name, micros }] of times.entries()) {
      const [label, value, bar] = this.passes.children[index]?.children ?? [];
      if (label !== undefined) label.textContent = words(name);
      if (value !== undefined) value.textContent = millis(micros / 1000);
      if (bar instanceof HTMLElement)
        bar.style.setProperty('width', `${(micros / longest) * 100}%`);
    }
  }

  private showPlan(plan: Plan): void {
    this.shownPlan = plan;
    const item = ({ pass, variant, reason }: Plan['passes'][number]) => {
      const title = el('b', {}, words(pass));
      if (variant !== '') title.append(el('small', {}, words(variant)));
      return el('li', {}, title, el('span', {}, reason));
    };
    this.planned.replaceChildren(...plan.passes.map(item));
    this.skipped.replaceChildren(...plan.skipped.map(item));
    this.skippedTitle.hidden = plan.skipped.length === 0;
  }
}
