import { callListener } from '../../data/listeners.ts';
import type { CloudPlanes } from '../cloud-planes.ts';
import { type CloudContents, SplatCloud } from '../splat-cloud.ts';

/** The previews of one load, one at a time. */
export class LoadPreviews {
  readonly #device: GPUDevice;
  readonly #name: string;
  readonly #onPreview: (preview: SplatCloud) => void;
  #shown: SplatCloud | null = null;
  #release = () => {};

  constructor(device: GPUDevice, name: string, onPreview: (preview: SplatCloud) => void) {
    this.#device = device;
    this.#name = name;
    this.#onPreview = onPreview;
  }

  /** The current preview; null before the first. */
  get shown(): SplatCloud | null {
    return this.#shown;
  }

  /** Replaces the preview. The caller keeps ownership of the planes. */
  show(planes: CloudPlanes, contents: CloudContents, visibleLimit?: number): void {
    const before = this.#shown;
    const options = { name: this.#name, isPreview: true, visibleLimit };
    this.#shown = new SplatCloud(this.#device, planes, contents, options);
    callListener(this.#onPreview, this.#shown);
    before?.destroy();
    this.#release();
  }

  /** Makes frames keep their image until the next preview. */
  hold(): void {
    const next = new Promise<void>((resolve) => {
      this.#release = resolve;
    });
    this.#shown?.holdImage(next);
  }

  end(): void {
    this.#shown?.destroy();
    this.#release();
  }
}
