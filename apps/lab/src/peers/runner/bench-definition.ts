import type { BuiltPages, BuiltPeer } from './built-pages.ts';
import type { ChosenPeer } from './peer-list.ts';
import type { CommandLine, Outcome } from './run-command.ts';

/** Options of every bench. */
export interface CommonOptions {
  /** Names, separated by commas. */
  readonly peers: string;
  readonly installs: boolean;
  readonly packFolder: string | null;
  readonly camerasFile: string | null;
  readonly size: SizePx;
  readonly pictureSize: SizePx;
  readonly rounds: number;
  readonly frames: number;
  readonly warmUpFrames: number;
  readonly takesPictures: boolean;
  readonly timeLimitMs: number;
  /** Infinity without a limit. */
  readonly budgetMs: number;
  readonly isSoftware: boolean;
  readonly outFolder: string | null;
  readonly jsonFile: string | null;
}

export interface SizePx {
  readonly widthPx: number;
  readonly heightPx: number;
}

/** Everything that a bench needs besides its options. */
export interface BenchSetup {
  /** Chromium's program. */
  readonly executablePath: string;
  /** For the report. */
  readonly commandLine: CommandLine;
  readonly pages: BuiltPages;
  /** Where the pages are. */
  readonly pagesFolder: string;
  /** For scenes that are made; it goes away with the bench. */
  readonly workFolder: string;
  readonly say: (line: string) => void;
}

/** A bench of peers, in a checkout and packed. */
export interface Bench<Options extends CommonOptions> {
  /** Of the root's package.json. */
  readonly script: string;
  /** What a pack runs: a path from src/peers. */
  readonly packedMain: string;
  /** Behind the command's name. */
  readonly usage: string;
  /** Reads the command line; paths are from `folder`. @throws BenchError */
  readOptions(args: readonly string[], folder: string): Options;
  /** Reads `options.peers`. @throws BenchError */
  choose(options: Options, folder: string): ChosenPeer[];
  /** @throws BenchError if a scene cannot be read. */
  measure(options: Options, peers: readonly BuiltPeer[], setup: BenchSetup): Promise<Outcome>;
}
