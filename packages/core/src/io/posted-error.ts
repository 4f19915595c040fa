import {
  type FilePlace,
  InvalidArgumentError,
  SplatFileError,
  type SplatFileErrorCode,
  SplatSourceError,
  WebSplatterError,
} from '../data/errors.ts';
import { shown } from '../data/printable.ts';

/** An error as plain data: structured clone drops classes and fields. */
export interface PostedError {
  readonly className: string;
  readonly message: string;
  readonly code?: string;
  readonly file?: string;
  readonly place?: FilePlace;
  readonly found?: string;
  readonly advice?: string;
  readonly status?: number;
  readonly argument?: string;
  /** Message of the error's cause. */
  readonly cause?: string;
}

export function toPostedError(error: unknown): PostedError {
  if (!(error instanceof Error)) return { className: 'Error', message: shown(error) };
  const { name: className, message, cause: reason } = error;
  const cause = reason instanceof Error ? String(reason) : reason === undefined ? undefined : shown(reason);
  // Errors of platforms have members of the same names that mean something else.
  const own: Partial<PostedError> = error instanceof WebSplatterError ? (error as Partial<PostedError>) : {};
  const { code, file, place, found, advice, status, argument } = own;
  return { className, message, cause, code, file, place, found, advice, status, argument };
}

/** Converts a posted error to its original class. */
export function fromPostedError(posted: PostedError): Error {
  const error = emptyError(posted, posted.cause === undefined ? {} : { cause: posted.cause });
  // Constructors append file and place to a message; this message already has them.
  error.message = posted.message;
  // Chromium and Node begin a stack with the error's first message, and consoles print stacks.
  error.stack = error.stack?.replace(/^\w*Error\b.*/, `${error.name}: ${error.message}`);
  return error;
}

function emptyError(
  { className, code, file = '', place, found, advice, status, argument = '' }: PostedError,
  options: ErrorOptions,
): Error {
  switch (className) {
    case 'SplatFileError':
      return new SplatFileError(
        code as SplatFileErrorCode,
        file,
        found ? [found, advice] : '',
        place,
        options,
      );
    case 'SplatSourceError':
      return new SplatSourceError(file, '', status, options);
    case 'InvalidArgumentError':
      return new InvalidArgumentError(argument, '');
    default:
      return code === undefined ? new Error('', options) : new WebSplatterError(code, '', options);
  }
}
