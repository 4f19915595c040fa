import { existsSync, readdirSync } from 'node:fs';

/** The machine as the search for a driver sees it, so that a test can pretend another one. */
export interface VulkanSurroundings {
  readonly env: Readonly<Record<string, string | undefined>>;
  /** Names in a directory, none where it cannot be read. */
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
