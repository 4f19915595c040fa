import { browserDecoder } from '../containers/browser-webp.ts';
import { type LoadPort, serveLoad, withPageDecoder } from '../loading/serve-load.ts';
import { ALL_READERS } from './readers.ts';

// Starts the probe for SOG images early, so that its result is ready before the images.
void browserDecoder();
const port = self as unknown as LoadPort;
serveLoad(port, withPageDecoder(port, ALL_READERS));
