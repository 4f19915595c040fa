import { type FrameSceneOptions, frameScene, type SceneFraming } from '@websplatter/core';
import type { CameraSubject } from '../../camera/view-camera.ts';
import type { ShownScene } from './shown-scene.ts';

interface FramedScene {
  /** Null if no splat can be seen. */
  readonly framing: SceneFraming | null;
  /** False after files were added, hidden or moved. */
  readonly isCurrent: boolean;
}

/** Computes and caches the first views of scenes. */
export class SceneFramer {
  readonly #found = new WeakMap<ShownScene, FramedScene>();

  /** @throws as `frameScene`. */
  async frame(scene: ShownScene, options: FrameSceneOptions): Promise<void> {
    const framing = await frameScene(scene.clouds, options);
    this.#found.set(scene, { framing, isCurrent: true });
  }

  /**
   * Reuses the first view of `scene` for `next`. If `isCurrent` is false, it stays the way the
   * scene began, without fitting its present parts.
   */
  keep(scene: ShownScene, next: ShownScene, isCurrent: boolean): void {
    const found = this.#found.get(scene);
    if (found) this.#found.set(next, { framing: found.framing, isCurrent: isCurrent && found.isCurrent });
  }

  isCurrent(scene: ShownScene): boolean {
    return this.#found.get(scene)?.isCurrent ?? false;
  }

  framingOf(scene: ShownScene): SceneFraming | null {
    return this.#found.get(scene)?.framing ?? null;
  }

  /** The scene data that the camera needs. */
  subjectOf(scene: ShownScene): CameraSubject {
    const framing = this.framingOf(scene);
    const detail =
      framing && this.isCurrent(scene) ? { center: framing.center, radius: framing.radius } : null;
    return { ...scene, framing, detail };
  }
}
