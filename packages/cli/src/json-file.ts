import { readFile } from 'node:fs/promises';
import { text as textOf } from 'node:stream/consumers';
import { shown as printed } from '@websplatter/core';
import { describeSystemError, InputFileError } from './input-error.ts';
import { STDIO } from './output-place.ts';

/** Reads a JSON file, or standard input for `-`; `kind` names its purpose in messages. */
export async function readJsonFile(file: string, kind: string): Promise<unknown> {
  let text: string;
  try {
    text = await (file === STDIO ? textOf(process.stdin) : readFile(file, 'utf8'));
  } catch (error) {
    throw new InputFileError(file, `the ${kind} cannot be read: ${describeSystemError(error)}`, undefined, {
      cause: error,
    });
  }
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new InputFileError(file, `the ${kind} is not JSON: ${(error as Error).message}`, undefined, {
      cause: error,
    });
  }
}

/** Formats a value for a message: short, on one line. */
export function shown(value: unknown): string {
  return value === undefined ? 'nothing' : printed(typeof value === 'string' ? `"${value}"` : value);
}

export function isObject(value: unknown): value is Record<string, unknown> {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

/** Whether `value` is an array of `length` finite numbers. */
export function isNumbers(value: unknown, length: number): value is number[] {
  return Array.isArray(value) && value.length === length && value.every((each) => Number.isFinite(each));
}
