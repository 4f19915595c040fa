import type { SceneCamera } from '@websplatter/scenes';
import type { Peer } from '../adapter.ts';
import type { Drawer } from './completion.ts';

/** A peer whose frames are drawn to their end. */
export class DrawnPeer {
  readonly peer: Peer;
  readonly canvas: HTMLCanvasElement;
  readonly drawer: Drawer;
  /** Resolves when the GPU has done all that it was given. */
  readonly completion: () => Promise<unknown> | undefined;

  constructor(
    peer: Peer,
    canvas: HTMLCanvasElement,
    drawer: Drawer,
    completion: () => Promise<unknown> | undefined,
  ) {
    this.peer = peer;
    this.canvas = canvas;
    this.drawer = drawer;
    this.completion = completion;
  }

  /** Draws one frame by the newest order that there is; resolves when the GPU is done. */
  async frame(): Promise<void> {
    await this.peer.draw();
    await this.completion();
  }

  /** Draws one frame in the right order. */
  async correctFrame(camera: SceneCamera): Promise<void> {
    this.peer.setCamera(camera);
    await this.peer.order?.();
    await this.frame();
  }
}
