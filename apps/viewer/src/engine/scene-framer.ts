import { type FrameSceneOptions, frameScene, type SceneFraming } from '@websplatter/core';
import type { CameraSubject } from '../camera/view-camera.ts';
import type { ShownScene } from './shown-scene.ts';

interface FramedScene {
  /** Null if no splat can be seen. */
  readonly framing: SceneFraming | null;
  /** False once files were added, hidden or moved since it was found. */
  readonly isCurrent: boolean;
}

/** Finds first views of scenes, and keeps them. */
export class SceneFramer {
  readonly #found = new WeakMap<ShownScene, FramedScene>();

  /** @throws as `frameScene`. */
  async frame(scene: ShownScene, options: FrameSceneOptions): Promise<void> {
    const framing = await frameScene(scene.clouds, options);
    this.#found.set(scene, { framing, isCurrent: true });
  }

  /** What was found for `scene` holds for `next`, too; with `isCurrent` false, only how it began. */
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

  /** The scene as its camera needs it. */
  subjectOf(scene: ShownScene): CameraSubject {
    const framing = this.framingOf(scene);
    const detail =
      framing && this.isCurrent(scene) ? { center: framing.center, radius: framing.radius } : null;
    return { ...scene, framing, detail };
  }
}
