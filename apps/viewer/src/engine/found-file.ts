/** A file, and its path from the folder that was dropped or chosen. */
export interface FoundFile {
  readonly path: string;
  readonly file: File;
}

/** A dropped folder may be a whole disk. */
export const MOST_FILES = 2000;
