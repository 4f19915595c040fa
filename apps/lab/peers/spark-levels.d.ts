import type { SplatCloud, SplatEngine } from '@websplatter/core';
import type { Levels } from '../src/peers/levels/levels.ts';

export declare function sparkLevels(
  engine: SplatEngine,
  { count, shDegree }: SplatCloud,
  plyFile: string,
): AsyncGenerator<Levels>;
