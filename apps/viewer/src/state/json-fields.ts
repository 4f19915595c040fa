import { shown } from '@websplatter/core';
import { isFiniteF32 } from './float32.ts';
import type { Vec3 } from './vec3.ts';

/** A field of a JSON file that cannot be used. */
export class FieldError extends Error {
  override readonly name = 'FieldError';

  /** @param path of the value, e.g. `background.color`; empty for the file as a whole. */
  constructor(path: string, found: unknown, needed: string) {
    const text = found === undefined ? 'missing' : shown(typeof found === 'string' ? `"${found}"` : found);
    super(`${path || 'The file'} is ${text}, but must be ${needed}.`);
  }
}

export type Json = Readonly<Record<string, unknown>>;

/** @throws FieldError, as the other functions, if the value is something else. */
export function objectAt(path: string, value: unknown): Json {
  if (typeof value !== 'object' || value === null || Array.isArray(value))
    throw new FieldError(path, value, 'an object');
  return value as Json;
}

export function arrayAt(path: string, value: unknown): readonly unknown[] {
  if (!Array.isArray(value)) throw new FieldError(path, value, 'a list');
  return value;
}

export function textAt(path: string, value: unknown): string {
  if (typeof value !== 'string') throw new FieldError(path, value, 'a string');
  return value;
}

export function numberAt(path: string, value: unknown): number {
  if (typeof value !== 'number' || !Number.isFinite(value)) throw new FieldError(path, value, 'a number');
  return value;
}

export function numbersAt(path: string, value: unknown, count?: number): readonly number[] {
  const numbers = arrayAt(path, value).map((each, i) => numberAt(`${path}[${i}]`, each));
  if (count !== undefined && numbers.length !== count)
    throw new FieldError(path, value, `a list of ${count} numbers`);
  return numbers;
}

export function vectorAt(path: string, value: unknown): Vec3 {
  const [x, y, z] = numbersAt(path, value, 3);
  return [x, y, z];
}

/** A point that is drawn: finite as float32, too. */
export function pointAt(path: string, value: unknown): Vec3 {
  const point = vectorAt(path, value);
  const wrong = point.findIndex((each) => !isFiniteF32(each));
  if (wrong >= 0) throw new FieldError(`${path}[${wrong}]`, point[wrong], 'a number of float32');
  return point;
}
