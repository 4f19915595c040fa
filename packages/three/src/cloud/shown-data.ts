import { DestroyedError, type SplatCloud } from '@websplatter/core';
import { SplatCloudObject } from './splat-cloud-object.ts';
import type { SplatData } from './splat-data.ts';

/** Objects that show data, on all renderers. */
function objectsOf({ places }: SplatData): SplatCloudObject[] {
  const users = [...places].flatMap((place) => [...place.users.keys()]);
  return [...new Set(users)].filter((user) => user instanceof SplatCloudObject);
}

/** Reports an error to the objects that show data; ignores a DestroyedError. */
export function tellObjects(data: SplatData, error: unknown): void {
  if (error instanceof DestroyedError) return;
  const isTold = objectsOf(data).reduce((isTold, object) => object.tell(error) || isTold, false);
  if (!isTold) console.error(error);
}

/** Gives data the bounds that one of their clouds has now. */
export function takeBounds({ bounds, robustBounds }: SplatData, cloud: SplatCloud): void {
  for (const [own, { min, max }] of [
    [bounds, cloud.bounds],
    [robustBounds, cloud.robustBounds],
  ] as const) {
    own.min.fromArray(min);
    own.max.fromArray(max);
  }
}

/** Announces changes of data to the objects that show them, once for all changes of a task. */
export class ChangeAnnouncer {
  readonly #data: SplatData;
  readonly #prepare: (clouds: readonly SplatCloud[]) => void;
  readonly #requestsFrames: boolean;
  #isAnnounced = false;

  /**
   * @param prepare called before, with the clouds that are there.
   * @param requestsFrames whether the changes are not in a frame yet.
   */
  constructor(
    data: SplatData,
    prepare: (clouds: readonly SplatCloud[]) => void = () => {},
    requestsFrames = true,
  ) {
    this.#data = data;
    this.#prepare = prepare;
    this.#requestsFrames = requestsFrames;
  }

  announce(): void {
    this.#data.renewRays();
    if (this.#isAnnounced) return;
    this.#isAnnounced = true;
    queueMicrotask(() => {
      this.#isAnnounced = false;
      this.#prepare([...this.#data.places].flatMap(({ cloud }) => (cloud instanceof Promise ? [] : cloud)));
      for (const object of objectsOf(this.#data)) {
        object.computeBoundingBox();
        if (this.#requestsFrames) object.requestFrame();
      }
    });
  }
}
