import { CloudPlanes } from '../clouds/cloud-planes.ts';
import { SplatCloud } from '../clouds/splat-cloud.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { ArrivedCloud } from './arrivals.ts';

/** The previews of one load; there is one at a time. */
export class LoadPreviews {
  readonly #memory: GpuMemory;
  readonly #name: string;
  readonly #onPreview: (preview: SplatCloud) => void;
  #shown: SplatCloud | null = null;

  constructor(memory: GpuMemory, name: string, onPreview: (preview: SplatCloud) => void) {
    this.#memory = memory;
    this.#name = name;
    this.#onPreview = onPreview;
  }

  /** The last preview. */
  get shown(): SplatCloud | null {
    return this.#shown;
  }

  /** Replaces the preview. @throws what the callback throws. */
  show({ contents, planes }: ArrivedCloud): void {
    const before = this.#shown;
    const held = new CloudPlanes(this.#memory, this.#name, planes);
    this.#shown = new SplatCloud(this.#memory.device, held, contents, { name: this.#name, isPreview: true });
    try {
      this.#onPreview(this.#shown);
    } finally {
      before?.destroy();
    }
  }

  /** Frames keep the image of the preview until the next one is shown. */
  hold(): void {
    if (this.#shown) this.#shown.isHeld = true;
  }

  end(): void {
    this.#shown?.destroy();
  }
}
