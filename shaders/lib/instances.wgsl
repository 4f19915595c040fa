// Selects the page of one instance of a batch, all of whose instances draw the same splats: with
// INSTANCES, each thread enters one instance before it reads `page`.
import constants::BATCH_INSTANCES;
import layout::Page;

/// Entries after the batch's last instance have no splats.
@group(0) @binding(1) var<uniform> pages: array<Page, BATCH_INSTANCES>;

/// Number of the entered instance in its batch.
var<private> instanceIndex: u32;
/// Its page but for the frustum: copied arrays would not stay in registers.
var<private> page: Page;

/// Enters the instance that a chunk of the batch belongs to, counting through the frame.
fn enterInstance(chunk: u32) {
  instanceIndex = min((chunk - pages[0].chunkStart) / pages[0].chunkCount, BATCH_INSTANCES - 1u);
  page.linear = pages[instanceIndex].linear;
  page.translation = pages[instanceIndex].translation;
  page.dilationPx2 = pages[instanceIndex].dilationPx2;
  page.camera = pages[instanceIndex].camera;
  page.cameraWeight = pages[instanceIndex].cameraWeight;
  page.sight = pages[instanceIndex].sight;
  page.direction = pages[instanceIndex].direction;
  page.cellStart = pages[instanceIndex].cellStart;
  page.chunkStart = pages[instanceIndex].chunkStart;
  page.chunkCount = pages[instanceIndex].chunkCount;
  page.splatCount = pages[instanceIndex].splatCount;
}
