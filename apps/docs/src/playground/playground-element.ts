import { KitFiles } from './kit-files.ts';
import type { Playground } from './playground.ts';

/**
 * `<ws-playground name paths>` contains an example's sources as code blocks. When it scrolls into
 * view, an editor replaces them, and the example runs. Without scripts the code blocks remain.
 */
export function definePlayground(kitUrl: URL): void {
  if (customElements.get('ws-playground')) return;
  const kit = new KitFiles(kitUrl);
  const images = new URL('../images/', kitUrl);
  customElements.define(
    'ws-playground',
    class extends HTMLElement {
      #observer: IntersectionObserver | null = null;
      #playground: Playground | null = null;

      connectedCallback(): void {
        this.#observer = new IntersectionObserver((entries) => {
          if (!entries.some(({ isIntersecting }) => isIntersecting)) return;
          this.#observer?.disconnect();
          void this.#start();
        });
        this.#observer.observe(this);
      }

      disconnectedCallback(): void {
        this.#observer?.disconnect();
        this.#playground?.close();
        this.#playground = null;
      }

      async #start(): Promise<void> {
        const { Playground } = await import('./playground.ts');
        if (!this.isConnected || this.#playground) return;
        const texts = [...this.querySelectorAll('pre code')].map((code) => `${code.textContent}\n`);
        const paths = this.getAttribute('paths')!.split(' ');
        const files = Object.fromEntries(paths.map((path, i) => [path, texts[i]]));
        this.classList.add('is-live');
        const name = this.getAttribute('name')!;
        this.#playground = new Playground(this, name, files, kit, new URL(`${name}.jpg`, images));
        await this.#playground.run();
      }
    },
  );
}
