import { type BrickPort, serveBricks } from './serve-bricks.ts';

serveBricks(self as unknown as BrickPort);
