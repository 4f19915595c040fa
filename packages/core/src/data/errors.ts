import type { CloudPrecision } from './packing/precision.ts';
import { printable } from './printable.ts';

/**
 * Base of every error that the engine throws on purpose. Each message names the thing, the value
 * found and the remedy. `code` is stable and meant for programs, `message` for people.
 */
export class WebSplatterError extends Error {
  // Written out in every class, because minifiers change the names of classes.
  override readonly name: string = 'WebSplatterError';
  readonly code: string;

  constructor(code: string, message: string, options?: ErrorOptions) {
    super(message, options);
    this.code = code;
  }
}

/** A place in a file; any part may be unknown. */
export interface FilePlace {
  /** Offset from the file's start, in bytes. */
  readonly byte?: number;
  /** Element name as in the file's header, e.g. `vertex`. */
  readonly element?: string;
  /** Property name, e.g. `f_dc_0`. */
  readonly property?: string;
  /** Row of the element, from 0. */
  readonly row?: number;
  /** Line of a text header or text body, from 1. */
  readonly line?: number;
  /** Bytes that the whole file has, at least, where it ends before. */
  readonly expectedBytes?: number;
}

/** Why a file cannot be read, for programs. */
export type SplatFileErrorCode =
  /** The bytes are in no supported format. */
  | 'unknown-format'
  /** The header is malformed. */
  | 'bad-header'
  /** A property has an unsupported type or place. */
  | 'bad-property'
  /** A point cloud or mesh, not splats: rotation, scale or colour is missing. */
  | 'not-splats'
  /** The file ends before all the data that its header promises. */
  | 'truncated'
  /** Packed data cannot be unpacked, or contradicts itself. */
  | 'damaged'
  /** Another file that the scene needs is not there. */
  | 'missing-part'
  /** A value in a text body cannot be read as a number. */
  | 'bad-value'
  /** The file has more bytes or splats than limits (`maxBytes`, `maxSplats`) or memory allow. */
  | 'too-large'
  /** The file has no splats. */
  | 'empty';

/** What a file is in place of splats, what to do, and further sentences: see `SplatFileError`. */
export type FileFinding = readonly [found: string, advice?: string, more?: string];

/** A file cannot be read as splats. Nothing from it was kept. */
export class SplatFileError extends WebSplatterError {
  override readonly name = 'SplatFileError';
  declare readonly code: SplatFileErrorCode;
  /** File name or URL, if known. */
  readonly file: string;
  readonly place: FilePlace;
  /**
   * What the file is in place of splats, for titles, to go on after its name: `is an image, not a splat file`.
   * Undefined if the message tells only what is wrong in it.
   */
  readonly found: string | undefined;
  /** What to do then, or what is missing, as a sentence without its full stop: `unpack it first`. */
  readonly advice: string | undefined;

  /** @param problem the message, or what the file is, of which the message is made. */
  constructor(
    code: SplatFileErrorCode,
    file: string,
    problem: string | FileFinding,
    place: FilePlace = {},
    options?: ErrorOptions,
  ) {
    const [found, advice, more] = typeof problem === 'string' ? [] : problem;
    const message = found ? `it ${found}${advice ? `; ${advice}` : ''}.${more ? ` ${more}` : ''}` : problem;
    super(code, printable(`${file}: ${message}${describePlace(place)}`), options);
    this.file = printable(file);
    this.place = place;
    this.found = found;
    this.advice = advice;
  }
}

/** A source could not be fetched or read (network, permission, missing file). */
export class SplatSourceError extends WebSplatterError {
  override readonly name = 'SplatSourceError';
  readonly file: string;
  /** HTTP status, if there was one. */
  readonly status: number | undefined;

  constructor(file: string, message: string, status?: number, options?: ErrorOptions) {
    super('unreadable-source', printable(`${file}: ${message}`), options);
    this.file = printable(file);
    this.status = status;
  }
}

/** WebGPU is not available, or not usable. */
export class WebGpuUnavailableError extends WebSplatterError {
  override readonly name = 'WebGpuUnavailableError';
  constructor(message: string, options?: ErrorOptions) {
    super('webgpu-unavailable', message, options);
  }
}

/** Options of `engine.load`; `fit` where only fewer degrees of harmonics would fit. */
export interface FittingOptions {
  readonly precision: CloudPrecision;
  readonly fit?: 'auto';
}

/** Further facts of a GpuLimitError; undefined if they are unknown. */
export interface GpuLimitDetails extends ErrorOptions {
  /** Bytes that the engine held already. */
  readonly heldBytes?: number;
  /** Options of a load that would fit. */
  readonly fitting?: FittingOptions | null;
}

/**
 * A cloud or a view exceeds a limit of the device (`maxBufferSize`, …), the engine's budget
 * (`memoryBudgetBytes`), or the GPU's memory (`memory`). Everything that was there before still is.
 */
export class GpuLimitError extends WebSplatterError {
  override readonly name = 'GpuLimitError';
  readonly limit: string;
  readonly neededBytes: number;
  /** 0 for `memory`, of which WebGPU does not tell how much there is. */
  readonly availableBytes: number;
  /** Bytes that the engine held already; undefined where they do not matter. */
  readonly heldBytes: number | undefined;
  /** Options of a load that would fit; null if none are known. */
  readonly fitting: FittingOptions | null;

  constructor(
    limit: string,
    neededBytes: number,
    availableBytes: number,
    message: string,
    { heldBytes, fitting = null, ...options }: GpuLimitDetails = {},
  ) {
    super('gpu-limit', message, options);
    this.limit = limit;
    this.neededBytes = neededBytes;
    this.availableBytes = availableBytes;
    this.heldBytes = heldBytes;
    this.fitting = fitting;
  }
}

/** An argument, option or setting has an invalid value. */
export class InvalidArgumentError extends WebSplatterError {
  override readonly name = 'InvalidArgumentError';
  /** Name of the argument or setting. */
  readonly argument: string;

  constructor(argument: string, message: string) {
    super('invalid-argument', message);
    this.argument = argument;
  }
}

/** Where a ShaderError comes from: see its members. */
export interface ShaderErrorDetails {
  readonly stage: string;
  readonly effects: readonly string[];
  readonly module: string | null;
  readonly line: number | null;
  /** @internal */
  readonly culprit: object | null;
}

/**
 * A shader cannot be linked or compiled, mostly because of the WGSL of an effect. Clouds are drawn without
 * the effects that are to blame.
 */
export class ShaderError extends WebSplatterError {
  override readonly name = 'ShaderError';
  /** The stage, e.g. `project`. */
  declare readonly stage: string;
  /** Names of the effects that are to blame; if it is not known which, all of the shader. Empty without any. */
  declare readonly effects: readonly string[];
  /** Module that the error is in, e.g. `package::effects::wind_sway`; null if it is not known. */
  declare readonly module: string | null;
  /** Line of the module, from 1; null if it is not known. */
  declare readonly line: number | null;
  /** @internal The effect or the set of effects that frames leave out; null if the shader has no effects. */
  declare readonly culprit: object | null;

  constructor(message: string, details: ShaderErrorDetails, options?: ErrorOptions) {
    super('shader', message, options);
    Object.assign(this, details);
  }
}

/** The device was lost, or the object was destroyed. */
export class DestroyedError extends WebSplatterError {
  override readonly name = 'DestroyedError';
  constructor(what: string, why: string) {
    super('destroyed', `${what} can no longer be used: ${why}.`);
  }
}

/** Code of this package that is fetched when it is needed could not be fetched. */
export class CodeUnavailableError extends WebSplatterError {
  override readonly name = 'CodeUnavailableError';

  /** @param code its name for people, e.g. `engine`. */
  constructor(code: string, options: { readonly cause: unknown }) {
    const { message } = options.cause as Error;
    super(
      'code-unavailable',
      `The code of the ${code} could not be fetched (${message}). Check the connection and try again; if the page has been ` +
        'published anew meanwhile, reload it.',
      options,
    );
  }
}

/**
 * Awaits a dynamic import.
 *
 * @internal
 * @param code name for people of the code in the module.
 * @returns the module.
 * @throws CodeUnavailableError if it cannot be fetched.
 * @example
 * const { openRad } = await fetched('streaming', import('./open-rad.ts'));
 */
export async function fetched<Module>(code: string, module: Promise<Module>): Promise<Module> {
  try {
    return await module;
  } catch (cause) {
    throw new CodeUnavailableError(code, { cause });
  }
}

const PLACE_PARTS = ['line', 'element', 'row', 'property', 'byte'] as const;

function describePlace(place: FilePlace): string {
  const known = PLACE_PARTS.filter((part) => place[part] !== undefined);
  return known.length > 0 ? ` (${known.map((part) => `${part} ${place[part]}`).join(', ')})` : '';
}
