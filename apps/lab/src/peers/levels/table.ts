import { markdownTable } from '../runner/report.ts';
import type { Levels } from './levels.ts';
import { DISTANCES, type Pictured } from './pictures.ts';

/** What has been measured of levels. */
export interface Measured extends Pick<Levels, 'name' | 'buildMs'> {
  readonly ofShares: readonly {
    readonly share: number;
    /** Null where nothing is chosen or timed. */
    readonly choiceMs: number | null;
    /** By distance. */
    readonly pictures: readonly Pictured[];
  }[];
}

/** What pictures tell, with how many digits. */
const COLUMNS = { drawn: 0, dB: 1, 'filtered dB': 1 };

/** A table of times and one of pictures, as Markdown that can also be read as it is. */
export function measuredTables(measured: readonly Measured[]): string[] {
  const shares = measured[0].ofShares.map(({ share }) => `${Math.round(100 * share)} %`);
  const columns = Object.entries(COLUMNS) as [keyof Pictured, number][];
  const times = measured.map(({ name, buildMs, ofShares }) => [
    name,
    buildMs.map((ms) => (ms / 1000).toFixed(2)).join(', '),
    ...ofShares.map(({ choiceMs }) => choiceMs?.toFixed(3) ?? '–'),
  ]);
  const pictures = shares.flatMap((share, i) =>
    measured.map(({ name, ofShares }) => {
      const cells = columns.map(([of, digits]) =>
        ofShares[i].pictures.map((each) => each[of].toFixed(digits)),
      );
      return [name, share, ...cells.flat()];
    }),
  );
  const distances = columns.flatMap(([of]) => DISTANCES.map((distance) => `${of}, ${distance}×`));
  return [
    [['levels', 'building, s', ...shares.map((share) => `choosing ${share}, ms`)], ...times],
    [['levels', 'share', ...distances], ...pictures],
  ].map((rows) => markdownTable(rows, 1).join('\n'));
}
