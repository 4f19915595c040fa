import { DestroyedError } from '@websplatter/core';

/** An object that rays are cast at: a SplatCloudObject. */
interface Listening {
  /** Passes an error to the listener, once per text; returns false without a listener. */
  tell(error: unknown): boolean;
}

/** Text of the error of rays that the console has of an object without a listener. */
const toldOfRays = new WeakMap<Listening, string>();

/** Reports that rays miss splats, once for each text: the next ray tries again. Freed splats are no error. */
export function tellOfRays(object: Listening, error: Error): void {
  if (error instanceof DestroyedError || object.tell(error)) return;
  if (toldOfRays.get(object) !== error.message) console.error(error);
  toldOfRays.set(object, error.message);
}
