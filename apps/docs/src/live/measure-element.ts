import { KitFiles } from '../playground/kit-files.ts';
import { MEASURE_ENTRY } from '../playground/kit-manifest.ts';
import type { MeasureHereOptions } from './measure.ts';
import { type Measured, measuredText } from './measured.ts';

/** Names of measurements, each with its function of `measure.ts`. */
const KINDS = { accuracy: 'measureAccuracyHere', performance: 'measurePerformanceHere' } as const;

type MeasureModule = Record<
  (typeof KINDS)[keyof typeof KINDS],
  (options: MeasureHereOptions) => Promise<Measured>
>;

/** `<ws-measure kind="accuracy|performance">`: a button that measures this device, and results. */
export function defineMeasure(kitUrl: URL): void {
  if (customElements.get('ws-measure')) return;
  const kit = new KitFiles(kitUrl);
  customElements.define(
    'ws-measure',
    class extends HTMLElement {
      #running: AbortController | null = null;

      connectedCallback(): void {
        const button = document.createElement('button');
        button.type = 'button';
        button.className = 'ws-button ws-run';
        button.textContent = 'Measure here';
        const status = document.createElement('p');
        status.className = 'ws-status';
        status.setAttribute('role', 'status');
        const result = document.createElement('div');
        this.replaceChildren(button, status, result);
        button.addEventListener('click', () => {
          if (this.#running) this.#running.abort();
          else void this.#measure(button, status, result);
        });
      }

      disconnectedCallback(): void {
        this.#running?.abort();
      }

      async #measure(button: HTMLElement, status: HTMLElement, result: HTMLElement): Promise<void> {
        const running = new AbortController();
        this.#running = running;
        button.textContent = 'Stop';
        status.textContent = 'Asking for the GPU …';
        try {
          const address = await kit.addressOf(MEASURE_ENTRY);
          const module: MeasureModule = await import(/* @vite-ignore */ address);
          const kind = KINDS[this.getAttribute('kind') as keyof typeof KINDS];
          const measured = await module[kind]({
            signal: running.signal,
            onProgress: ({ done, total, label }) => {
              status.textContent = `${Math.floor((100 * done) / total)} %: ${label}`;
            },
          });
          status.textContent = '';
          result.replaceChildren(...resultParts(measured, status));
        } catch (error) {
          status.textContent = running.signal.aborted ? 'Stopped.' : (error as Error).message;
        } finally {
          this.#running = null;
          button.textContent = 'Measure again';
        }
      }
    },
  );
}

function resultParts(measured: Measured, status: HTMLElement): HTMLElement[] {
  const facts = document.createElement('p');
  facts.className = 'ws-facts';
  facts.textContent = measured.facts.join(' · ');
  const table = document.createElement('table');
  const head = table.createTHead().insertRow();
  for (const column of measured.columns) head.append(heading(column, 'col'));
  const body = table.createTBody();
  for (const [name, ...cells] of measured.rows) {
    const row = body.insertRow();
    row.append(heading(name, 'row'));
    for (const cell of cells) row.insertCell().textContent = cell;
  }
  const notes = measured.notes.map((note) => {
    const line = document.createElement('p');
    line.textContent = note;
    return line;
  });
  const copy = document.createElement('button');
  copy.type = 'button';
  copy.className = 'ws-button';
  copy.textContent = 'Copy as text';
  copy.addEventListener('click', async () => {
    const text = `${measuredText(measured)}${navigator.userAgent}\n`;
    try {
      await navigator.clipboard.writeText(text);
      status.textContent = 'Copied.';
    } catch {
      status.textContent = 'The browser does not let pages copy: select the table instead.';
    }
  });
  return [facts, table, ...notes, copy];
}

function heading(text: string, scope: 'row' | 'col'): HTMLElement {
  const cell = document.createElement('th');
  cell.scope = scope;
  cell.textContent = text;
  return cell;
}
