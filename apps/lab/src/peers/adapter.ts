import type { SceneCamera } from '@websplatter/scenes';

/** The page's side of an adapter. */
export interface PeerHost {
  /** In the page, of the picture's size in CSS and device pixels. All drawing goes to it. */
  readonly canvas: HTMLCanvasElement;
  /**
   * Address of the scene, a single file in one of the adapter's {@link PeerFormats}; of a file on
   * the page, a `blob:` address.
   */
  readonly url: string;
  /** The scene's name without folders: its end tells the format, which a `blob:` address hides. */
  readonly fileName: string;
  /** The file that was dropped onto the page, if the scene is not fetched. */
  readonly file: File | null;
  /** The one that `setCamera` gets first, for frames while the scene loads. */
  readonly camera: SceneCamera;
  /** Options behind the peer's name on the command line: `websplatter?accuracy=fast`. */
  readonly options: URLSearchParams;
  /**
   * For peers that show a part while the rest loads: to be called once a frame with the first
   * splats is submitted.
   */
  shown(): void;
}

/**
 * The export `formats` of an adapter: the formats that its renderer reads, by the names of
 * `SPLAT_FORMATS`, each with a variant if not all are read (`spz 3`); `any` for all that this
 * repository reads. Without it, PLY alone.
 */
export type PeerFormats = readonly string[] | 'any';

/**
 * The default export of an adapter: loads the scene and prepares to draw it over black. Resolves
 * when everything is there that a frame needs, and rejects if the scene cannot be drawn; the page
 * times it together with the first frame.
 */
export type LoadPeer = (host: PeerHost) => Promise<Peer>;

/** A renderer with a scene. The page waits for the GPU, keeps the time and takes the pictures. */
export interface Peer {
  /** Settings that differ from the defaults, and things that are not drawn. */
  readonly note: string;
  setCamera(camera: SceneCamera): void;
  /** Submits one frame by the newest camera, even if nothing has changed. */
  draw(): void | Promise<void>;
  /**
   * Only where the order is made outside of the frame, by a worker or the CPU: resolves when there
   * is an order for the newest camera, which the next frame shows.
   */
  order?(): Promise<void>;
  /** With {@link order}: how many orders have been made so far. */
  orders?(): number;
  /**
   * Only of a scene that streams, whose {@link LoadPeer} resolves as soon as a frame can be drawn:
   * whether all is there and drawn that the newest camera needs within its budgets, by the peer's
   * own account.
   */
  isComplete?(): boolean;
  /** The peer's own figures, for the JSON. */
  figures?(): Readonly<Record<string, unknown>>;
}

type Vector = readonly [number, number, number];

/** The camera's axes in the world as COLMAP and 3DGS have them: right, down and forward. */
export function cameraAxes({ position, target, up }: SceneCamera): {
  readonly right: Vector;
  readonly down: Vector;
  readonly forward: Vector;
} {
  const forward = unit([target[0] - position[0], target[1] - position[1], target[2] - position[2]]);
  const right = unit(cross(forward, up));
  return { right, down: cross(forward, right), forward };
}

/** The matrix from the world to these axes, column-major. */
export function colmapView(camera: SceneCamera): number[] {
  const { right, down, forward } = cameraAxes(camera);
  const axes = [right, down, forward];
  const shift = axes.map((axis) => -axis.reduce((sum, value, i) => sum + value * camera.position[i], 0));
  return [...[0, 1, 2].flatMap((i) => [...axes.map((axis) => axis[i]), 0]), ...shift, 1];
}

/** Resolves in the next task, after workers' messages; unlike timers, without a delay. */
export function nextTask(): Promise<void> {
  return new Promise((resolve) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => {
      port1.close();
      resolve();
    };
    port2.postMessage(null);
  });
}

/** Fetches a file and throws its bytes away. */
export async function fetchAway(url: string): Promise<void> {
  const { body } = await fetch(url);
  await body?.pipeTo(new WritableStream());
}

function cross(a: Vector, b: Vector): Vector {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function unit(vector: Vector): Vector {
  const length = Math.hypot(...vector);
  return [vector[0] / length, vector[1] / length, vector[2] / length];
}
