import { InvalidArgumentError, WebSplatterError } from '@websplatter/core';

/** An unusable file on the command line. The message names the file, the cause and the place. */
export class InputFileError extends WebSplatterError {
  constructor(file: string, cause: string, place?: string, options?: ErrorOptions) {
    super('bad-input-file', `${file}: ${cause}${place === undefined ? '' : ` (${place})`}`, options);
  }
}

/** The process that reads standard output closed the pipe early (EPIPE). */
export class ReaderLeftError extends WebSplatterError {
  constructor(options: { readonly cause: unknown }) {
    super('reader-left', 'The reader of standard output has left before the end.', options);
  }
}

/** The command line itself cannot be understood. */
export class UsageError extends InvalidArgumentError {
  constructor(argument: string, message: string) {
    super(argument, `${message} (see websplatter --help)`);
  }
}

/** The error for an option with a value that it cannot have. */
export function wrongValue(option: string, value: string, expected: string): UsageError {
  return new UsageError(option, `${option} is ${value}; it must be ${expected}`);
}

/** Describes a failed system call in words: `there is no such file or folder`. */
export function describeSystemError(error: unknown): string {
  const code = (error as NodeJS.ErrnoException | null)?.code;
  switch (code) {
    case 'ENOENT':
      return 'there is no such file or folder';
    case 'EACCES':
    case 'EPERM':
      return 'permission denied';
    case 'EISDIR':
      return 'it is a folder, not a file';
    case 'ENOTDIR':
      return 'a part of the path is a file, not a folder';
    case 'ENAMETOOLONG':
      return 'the name or the path is longer than the system allows';
    case 'EROFS':
      return 'the disk is read-only';
    case 'ENOSPC':
      return 'the disk is full';
    default:
      return error instanceof Error ? error.message : String(error);
  }
}
