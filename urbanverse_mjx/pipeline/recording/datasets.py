"""Summary and checks of a dataset; the functions of `urbanverse_mjx.datasets`."""

from ...datasets import check_dataset, dataset_page, summarise_dataset

__all__ = ["check_dataset", "dataset_page", "summarise_dataset"]
