import { existsSync, readdirSync } from 'node:fs';

/** The parts of a machine that the search for a driver reads; tests replace them. */
export interface VulkanSurroundings {
  readonly env: Readonly<Record<string, string | undefined>>;
  /** Returns the names in a directory; empty if it cannot be read. */
  readonly listDirectory: (path: string) => readonly string[];
  readonly fileExists: (path: string) => boolean;
}

/** This machine. */
export function realSurroundings(): VulkanSurroundings {
  return {
    env: process.env,
    fileExists: existsSync,
    listDirectory(path) {
      try {
        return readdirSync(path);
      } catch {
        return [];
      }
    },
  };
}
