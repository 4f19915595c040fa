import { encodePly } from '@websplatter/core';
import { stillLife } from '@websplatter/scenes';
import { ring } from './ring.ts';

export const stillLifePly = () => encodePly(stillLife({ splats: 60_000, shDegree: 1 }));

export const ringPly = () => encodePly(ring());
