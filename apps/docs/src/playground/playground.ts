import { CompileError, compile, type SourceFiles } from './compile.ts';
import { SourceEditor } from './editor.ts';
import { ExampleFrame } from './example-frame.ts';
import type { KitFiles } from './kit-files.ts';
import type { RunReport } from './run-messages.ts';

const basename = (path: string): string => path.slice(path.lastIndexOf('/') + 1);

/** An editor beside the page that its source renders. */
export class Playground {
  readonly #files: SourceFiles;
  readonly #kit: KitFiles;
  readonly #parts: Parts;
  readonly #editor: SourceEditor;
  readonly #frame: ExampleFrame;
  readonly #paths: readonly string[];
  #path: string;

  /**
   * @param title the example's title, for screen readers.
   * @param poster URL of the picture shown until the first run draws.
   */
  constructor(parent: HTMLElement, title: string, files: SourceFiles, kit: KitFiles, poster: URL) {
    this.#files = files;
    this.#kit = kit;
    this.#paths = Object.keys(files);
    this.#path = this.#paths[0];
    this.#parts = makeParts(parent, title, this.#paths, poster);
    const { code, run, reset, tabs, goTo } = this.#parts;
    this.#editor = new SourceEditor(code, this.#path, files[this.#path], () => void this.run());
    this.#frame = new ExampleFrame(kit, `What the example “${title}” draws`, (report) => this.#tell(report));
    run.addEventListener('click', () => void this.run());
    reset.addEventListener('click', () => this.#reset());
    tabs.forEach((tab, i) => {
      tab.addEventListener('click', () => this.#show(this.#paths[i]));
    });
    goTo.addEventListener('click', () => {
      const { path, line } = goTo.dataset;
      if (!path || !line) return;
      this.#show(path);
      this.#editor.goTo(Number(line));
    });
    this.#show(this.#path);
  }

  /** Runs the editor's text and shows problems beside it. */
  async run(): Promise<void> {
    this.#clearProblem();
    this.#say('Compiling …');
    const files = { ...this.#files, ...this.#editor.texts() };
    try {
      const { entries } = await this.#kit.manifest();
      const compiled = compile(files, new Set(Object.keys(entries)));
      if (!(await hasGpu())) {
        this.#say('A picture: to run the example, open this page in a browser with WebGPU');
        return;
      }
      this.#say('Loading …');
      this.#frame.setDark(document.documentElement.classList.contains('dark'));
      await this.#frame.run(this.#parts.stage, compiled, Object.values(files).join('\n'));
    } catch (error) {
      const place = error instanceof CompileError ? error : { path: null, line: null };
      this.#tell({ kind: 'problem', message: (error as Error).message, path: place.path, line: place.line });
    }
  }

  close(): void {
    this.#frame.close();
    this.#editor.close();
    this.#parts.root.remove();
  }

  #show(path: string): void {
    this.#path = path;
    this.#editor.show(path, this.#files[path]);
    this.#parts.tabs.forEach((tab, i) => {
      tab.setAttribute('aria-pressed', String(this.#paths[i] === path));
    });
  }

  #reset(): void {
    this.#path = this.#paths[0];
    this.#editor.reset(this.#path, this.#files[this.#path]);
    this.#show(this.#path);
    void this.run();
  }

  #tell(report: RunReport): void {
    const { poster, problem, message, goTo } = this.#parts;
    poster.hidden ||= report.kind !== 'running';
    if (report.kind !== 'problem') {
      if (report.kind === 'running' && problem.hidden) this.#say('Running');
      return;
    }
    // Later problems follow from the first one.
    if (!problem.hidden) return;
    this.#say('');
    message.textContent = report.message;
    const { path, line } = report;
    const isHere = path !== null && line !== null && this.#paths.includes(path);
    goTo.hidden = !isHere;
    goTo.textContent = isHere ? `${basename(path)}, line ${line}` : '';
    if (isHere) {
      goTo.dataset.path = path;
      goTo.dataset.line = String(line);
      if (path === this.#path) this.#editor.mark(line);
    }
    problem.hidden = false;
  }

  #clearProblem(): void {
    this.#parts.problem.hidden = true;
    this.#editor.mark(null);
  }

  #say(text: string): void {
    this.#parts.status.textContent = text;
    // The first picture takes a while after the code has started.
    this.#parts.badge.textContent = text === 'Running' ? 'Loading …' : text;
  }
}

/** Whether a GPU can draw. If not, the example's picture tells more than the example's message. */
async function hasGpu(): Promise<boolean> {
  // Some browsers reject where others answer with null.
  return Boolean(await navigator.gpu?.requestAdapter().catch(() => null));
}

interface Parts {
  readonly root: HTMLElement;
  readonly stage: HTMLElement;
  /** Covers the stage until the first run draws; its badge names the current step. */
  readonly poster: HTMLElement;
  readonly badge: HTMLElement;
  readonly code: HTMLElement;
  readonly tabs: readonly HTMLButtonElement[];
  readonly run: HTMLButtonElement;
  readonly reset: HTMLButtonElement;
  readonly status: HTMLElement;
  readonly problem: HTMLElement;
  readonly message: HTMLElement;
  readonly goTo: HTMLButtonElement;
}

function makeParts(parent: HTMLElement, title: string, paths: readonly string[], posterUrl: URL): Parts {
  const root = element('section', 'ws-live');
  root.setAttribute('aria-label', `Example: ${title}`);
  const image = Object.assign(document.createElement('img'), { src: posterUrl.href, alt: '' });
  const badge = element('span', 'ws-badge');
  const poster = element('div', 'ws-poster', image, badge);
  // The status has the same text.
  poster.setAttribute('aria-hidden', 'true');
  const stage = element('div', 'ws-stage', poster);
  const tabs = paths.map((path) => button(basename(path), 'ws-tab'));
  const files = element('div', 'ws-tabs', ...tabs);
  const status = element('p', 'ws-status');
  status.setAttribute('role', 'status');
  const reset = button('Reset', 'ws-button');
  const run = button('Run', 'ws-button ws-run');
  run.title = 'Ctrl+Enter';
  const message = element('p', 'ws-message');
  const goTo = button('', 'ws-go-to');
  const problem = element('div', 'ws-problem', message, goTo);
  problem.setAttribute('role', 'alert');
  problem.hidden = true;
  const code = element('div', 'ws-code');
  root.append(stage, element('div', 'ws-bar', files, status, reset, run), problem, code);
  parent.append(root);
  return { root, stage, poster, badge, code, tabs, run, reset, status, problem, message, goTo };
}

function element(name: string, className: string, ...children: HTMLElement[]): HTMLElement {
  const made = document.createElement(name);
  made.className = className;
  made.append(...children);
  return made;
}

function button(text: string, className: string): HTMLButtonElement {
  const made = document.createElement('button');
  made.type = 'button';
  made.className = className;
  made.textContent = text;
  return made;
}
