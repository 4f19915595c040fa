import type { CompiledModules } from './compile.ts';
import type { KitFiles } from './kit-files.ts';
import { MOUNT_ENTRY } from './kit-manifest.ts';
import type { RunMessage, RunReport } from './run-messages.ts';

/** Receives the reports of a running example. */
export type OnReport = (report: RunReport) => void;

/**
 * An iframe that runs each example in a page of its own, isolated from this page and its server.
 */
export class ExampleFrame {
  readonly #kit: KitFiles;
  readonly #title: string;
  readonly #onReport: OnReport;
  #frame: HTMLIFrameElement | null = null;
  #isDark = false;

  /** @param title describes the frame for screen readers. */
  constructor(kit: KitFiles, title: string, onReport: OnReport) {
    this.#kit = kit;
    this.#title = title;
    this.#onReport = onReport;
    addEventListener('message', this.#receive);
  }

  /**
   * Replaces the example in `parent` by `compiled`; `sources` determine which scenes it may load.
   */
  async run(parent: HTMLElement, compiled: CompiledModules, sources: string): Promise<void> {
    const { entries, scenes } = await this.#kit.manifest();
    const packages = [...compiled.packages, MOUNT_ENTRY, 'react/jsx-runtime'];
    const [kit, loadWorker, runner, style, named] = await Promise.all([
      this.#kit.modules(packages),
      this.#kit.text('load-worker.js'),
      this.#kit.text('runner.js'),
      this.#kit.text('examples.css'),
      Promise.all(
        scenes
          .filter((name) => sources.includes(name))
          .map(async (name) => [name, await this.#kit.scene(name)]),
      ),
    ]);
    const reachableEntries = Object.entries(entries).filter(([, file]) => Object.hasOwn(kit, file));
    this.#whenReady = () =>
      this.#post({
        kind: 'run',
        kit,
        entries: Object.fromEntries(reachableEntries),
        modules: compiled.modules,
        entry: compiled.entry,
        loadWorker,
        scenes: Object.fromEntries(named),
      });
    const frame = document.createElement('iframe');
    frame.title = this.#title;
    frame.sandbox.add('allow-scripts', 'allow-pointer-lock');
    frame.srcdoc = page(runner, style, this.#isDark);
    this.#frame?.remove();
    this.#frame = frame;
    parent.append(frame);
  }

  /** Applies to frames of later runs. */
  setDark(isDark: boolean): void {
    this.#isDark = isDark;
  }

  close(): void {
    removeEventListener('message', this.#receive);
    this.#frame?.remove();
    this.#frame = null;
  }

  #whenReady = () => {};

  #post(message: RunMessage): void {
    // An opaque origin cannot be named as a target.
    this.#frame?.contentWindow?.postMessage(message, '*');
  }

  #receive = ({ source, data }: MessageEvent<RunReport>) => {
    if (source === null || source !== this.#frame?.contentWindow) return;
    if (data.kind === 'ready') this.#whenReady();
    else this.#onReport(data);
  };
}

/** The page that an example runs in. */
function page(runner: string, style: string, isDark: boolean): string {
  const script = runner.replaceAll('</script', '<\\/script');
  const scheme = isDark ? 'dark' : 'light';
  return `<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>Example</title>
<style>${style}</style>
<style>
  :root { color-scheme: ${scheme}; }
  html, body { height: 100%; }
  body { overflow: hidden; }
  .stage { height: 100%; }
  body > canvas { display: block; width: 100%; height: 100%; }
</style>
<body>
<script>${script}</script>
`;
}
