import { type BuildPort, serveBuilder } from '../geometry-builder.ts';
import { FRAMING_BUILDERS } from './framing-builder.ts';

serveBuilder(self as unknown as BuildPort, FRAMING_BUILDERS);
