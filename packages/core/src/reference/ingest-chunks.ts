/** Reference of ingest-chunks: the host's own bounds, from log scales before they were rounded. */
export { chunkBounds as ingestChunks } from '../packing/packed-cloud.ts';
