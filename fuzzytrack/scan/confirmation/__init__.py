"""Confirmation: when tentative tracks are confirmed, and when tracks end."""

from fuzzytrack.scan.confirmation.base import Confirmation, ConfirmationKernels, confirmations
from fuzzytrack.scan.confirmation.count import Count
from fuzzytrack.scan.confirmation.evidence import Evidence

__all__ = ["Confirmation", "ConfirmationKernels", "Count", "Evidence", "confirmations"]
